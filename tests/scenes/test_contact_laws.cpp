// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/contact_laws.hpp>

#include <lagrain/run.hpp>
#include <lagrain/scene.hpp>

#include "support/space.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

using namespace lagrain;
using namespace lagrain::test;

namespace {

/// A scene of two balls whose table [law] holds every key of the two laws, in SI.
template <int Dim>
std::string scene_text(const LawDescription& normal, const LawDescription& friction) {
  const std::string zeros = Dim == 2 ? "0" : "0, 0";
  std::string text = "dimension = " + std::to_string(Dim) +
                     "\nduration = 1\ntime_step = \"1/200 contact\"\ngravity = [" + zeros +
                     ", -9.81]\nnormal = \"" + std::string(normal.word) + "\"\nfriction = \"" +
                     std::string(friction.word) + "\"\n[law]\n";
  for (const auto& keys : {normal.keys, friction.keys}) {
    for (const LawKey& key : keys) {
      if (Dim == 2 && key.in_space_only) continue;
      text += std::string(key.name) + (key.range == Range::fraction
                                           ? " = 0.625\n"
                                           : " = \"0.625 " + std::string(key.unit) + "\"\n");
    }
  }
  return text + "[materials.steel]\ndensity = 7800\n[[grain]]\nposition = [" + zeros +
         ", 1]\nradius = 0.1\n[[grain]]\nposition = [" + zeros + ", 2]\nradius = 0.1\n";
}

}  // namespace

TEST_SUITE("contact laws") {
  TEST_CASE("words are those of the scene files, each once") {
    CHECK(description_of(NormalModel::linear).word == "linear");
    CHECK(description_of(NormalModel::hertz).word == "hertz");
    CHECK(description_of(FrictionModel::none).word == "none");
    CHECK(description_of(FrictionModel::viscous).word == "viscous");
    CHECK(description_of(FrictionModel::elastic).word == "elastic");
    CHECK(description_of(FrictionModel::rolling).word == "rolling");
  }

  TEST_CASE_TEMPLATE("each pair of laws is read with all its keys, written, and run by its name", S,
                     Space<2>, Space<3>) {
    for (std::size_t n = 0; n < kNormalLaws.size(); ++n) {
      for (std::size_t f = 0; f < kFrictionLaws.size(); ++f) {
        CAPTURE(kNormalLaws[n].word);
        CAPTURE(kFrictionLaws[f].word);

        const auto scene =
            parse_scene<S::Dim>(scene_text<S::Dim>(kNormalLaws[n], kFrictionLaws[f]), "s.toml");

        CHECK(scene.normal == static_cast<NormalModel>(n));
        CHECK(scene.friction == static_cast<FrictionModel>(f));
        for (const auto& keys : {kNormalLaws[n].keys, kFrictionLaws[f].keys}) {
          for (const LawKey& key : keys) {
            if (S::Dim == 3 || !key.in_space_only) CHECK(scene.law.*key.number == 0.625);
          }
        }
        CHECK(to_toml(parse_scene<S::Dim>(to_toml(scene), "again.toml")) == to_toml(scene));
        const std::string text = explain(*make_run(scene));
        CHECK(text.find(std::string(kNormalLaws[n].in_words) + ", " +
                        std::string(kFrictionLaws[f].in_words)) != std::string::npos);
      }
    }
  }

  TEST_CASE("a key that is missing takes the law's own default") {
    std::string text =
        scene_text<2>(description_of(NormalModel::linear), description_of(FrictionModel::viscous));
    const std::string line = "tangential_damping = \"0.625 \"\n";
    REQUIRE(text.find(line) != std::string::npos);
    text.erase(text.find(line), line.size());

    CHECK(parse_scene<2>(text, "s.toml").law.tangential_damping ==
          ViscousFriction<LinearSpring>{}.tangential_damping_ratio);
  }

  TEST_CASE("a law is made from the numbers that its keys name") {
    LawNumbers numbers;
    numbers.stiffness = 3;
    numbers.restitution = 0.5;
    numbers.friction = 0.25;
    numbers.stiffness_ratio = 0.75;
    numbers.tangential_damping = 0.125;

    const auto law = make_law<LinearSpring, CundallStrack>(numbers);

    CHECK(law.normal.stiffness == 3);
    CHECK(law.normal.damping_ratio == damping_ratio_for(0.5));
    CHECK(law.friction == 0.25);
    CHECK(law.stiffness_ratio == 0.75);
    CHECK(law.tangential_damping_ratio == 0.125);

    numbers.rolling_friction = 0.0625;
    numbers.twisting_friction = 0.03125;
    numbers.rolling_stiffness_ratio = 2;
    numbers.rolling_damping = 0.7;
    const auto rolling = make_law<LinearSpring, RollingFriction>(numbers);
    CHECK(rolling.sliding.friction == 0.25);
    CHECK(rolling.rolling_friction == 0.0625);
    CHECK(rolling.twisting_friction == 0.03125);
    CHECK(rolling.stiffness_ratio == 2);
    CHECK(rolling.damping_ratio == 0.7);
  }
}
