// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/audit.hpp>

#include <support/motion_scenes.hpp>
#include <support/space.hpp>

#include <doctest/doctest.h>

#include <utility>

using namespace lagrain;
using namespace lagrain::test;

namespace {

constexpr int kBeyondBruteForce = ContactSearch<2>::kBruteForceLimit + 500;

}  // namespace

TEST_SUITE("audit") {
  TEST_CASE_TEMPLATE("the audit counts the contacts that a list lacks, by brute force and by cells",
                     S, Space<2>, Space<3>) {
    for (const auto& kind_and_count :
         {std::pair{CloudKind::kUniform, 200}, std::pair{CloudKind::kUniform, kBeyondBruteForce},
          std::pair{CloudKind::kSizes, kBeyondBruteForce}}) {
      const CloudKind kind = kind_and_count.first;
      const int count = kind_and_count.second;
      CAPTURE(count);
      Random random(10);
      const auto cloud = make_cloud<S::Dim>(kind, count, random);
      Eigen::VectorXd margin = Eigen::VectorXd::Zero(count);
      std::vector<Pair> contacts;
      AllPairs<S::Dim>{}.near_pairs(cloud.x, cloud.radius, margin, contacts);
      REQUIRE(contacts.size() > 10);
      ContactAudit<S::Dim> audit;

      audit.check(cloud.x, cloud.radius, contacts);
      CHECK(audit.missed() == 0);
      contacts.erase(contacts.begin() + 3);
      contacts.pop_back();
      audit.check(cloud.x, cloud.radius, contacts);

      CHECK(audit.missed() == 2);
      CHECK(audit.checks() == 2);
      CHECK(audit.contacts() == 2 * static_cast<std::int64_t>(contacts.size() + 2));
    }
  }
}
