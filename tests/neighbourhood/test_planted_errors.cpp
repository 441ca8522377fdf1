// SPDX-License-Identifier: GPL-3.0-or-later
// Whatever is kept beside the simplices because it is faster: an audit finds nothing wrong with it,
// and names an error that is planted in it.

#include <lagrain/near_list.hpp>
#include <lagrain/reach_list.hpp>
#include <lagrain/triangulation_neighbourhood.hpp>

#include <lagrain/cell_grid.hpp>
#include <lagrain/check.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>

#include <support/audit_probe.hpp>
#include <support/motion_scenes.hpp>
#include <support/site_sets.hpp>
#include <support/space.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;
using Probe = AuditProbe;

namespace {

constexpr int kCount = 60;
constexpr int kHiddenFirst = 1, kHiddenNext = 3;  ///< sites that lie within others
constexpr int kAbsent = 5;                        ///< an id that is not in use
constexpr int kVisible = 10;

// ---- Triangulations ----------------------------------------------------------------------------

/// A triangulation of sites of which two are hidden and one has been removed, so that it holds dead
/// triangles or tetrahedra.
template <int Dim>
Triangulation<Dim> some_triangulation() {
  Random random(1);
  const auto cloud = make_cloud<Dim>(CloudKind::kUniform, kCount, random);
  SiteSet<Dim> s{"some", cloud.x, 0.25 * cloud.radius.array().square()};
  for (const int id : {kHiddenFirst, kHiddenNext}) {
    s.x.col(id) = s.x.col(id - 1) + Vec<Dim>::Constant(0.01);
    s.w[id] = -1;
  }
  auto t = built(s);
  t.remove(kAbsent);
  return t;
}

/// What an audit says, in one string.
template <int Dim>
std::string report_of(const Triangulation<Dim>& t) {
  return audited(t);
}
std::string report_of(const std::vector<std::string>& defects) {
  std::string text;
  for (const std::string& defect : defects) text += defect + "; ";
  return text;
}

/// Another site or weight, of which T knows nothing.
template <int Dim, class Change>
void change_unseen(Triangulation<Dim>& t, int id, Change&& change) {
  const auto k = static_cast<std::size_t>(id);
  change(Probe::sites(t)[k]);
  Probe::places_before(t)[k] = Probe::sites(t)[k];
}

/// Moves nothing.
template <int Dim>
void update(Triangulation<Dim>& t) {
  const auto count = static_cast<Eigen::Index>(t.size());
  t.move({}, Columns<Dim>::Zero(Dim, count), Eigen::VectorXd::Zero(count));
}

/// A pair of sites without an edge.
template <int Dim>
Edge no_edge(const Triangulation<Dim>& t) {
  const auto list = edges(t);
  int j = 1;
  while (std::binary_search(list.begin(), list.end(), Edge{0, j})) ++j;
  return {0, j};
}

template <int Dim>
int dead_simplex(const Triangulation<Dim>& t) {
  const auto& topology = Probe::topology(t);
  int simplex = 0;
  while (topology.alive(simplex)) ++simplex;
  return simplex;
}

/// Simplices of full dimension, infinite ones left out.
template <int Dim>
int finite_simplex(const Triangulation<Dim>& t, int skipped = 0) {
  const auto& topology = Probe::topology(t);
  int simplex = 0;
  while (!topology.alive(simplex) || topology.infinite(simplex) || skipped-- > 0) ++simplex;
  return simplex;
}

/// A fan around the site 0, or in space around the edge of the sites 0 and 1, that goes round
/// `turns` times: its rim of ten sites does. T is told where they are for one turn.
template <int Dim>
Triangulation<Dim> fan(int turns) {
  constexpr int kRim = 10, kInner = Dim - 1;
  SiteSet<Dim> s{"fan", Columns<Dim>::Zero(Dim, kInner + kRim),
                 Eigen::VectorXd::Zero(kInner + kRim)};
  const auto place_rim = [&](int round) {
    for (int k = 0; k < kRim; ++k) {
      const double angle = 2 * std::numbers::pi * round * k / kRim;
      s.x.col(kInner + k).template head<2>() << std::cos(angle), std::sin(angle);
    }
  };
  if constexpr (Dim == 3) s.x.row(2).head(2) << -0.5, 0.5;
  place_rim(1);
  auto t = built(s);
  place_rim(turns);
  for (int k = kInner; k < kInner + kRim; ++k) {
    change_unseen(t, k, [&](auto& site) {
      site.x = s.x(0, k);
      site.y = s.x(1, k);
    });
  }
  return t;
}

// ---- Lists -------------------------------------------------------------------------------------

/// A list of balls that meet, and the T that it walks in. Ball 0 hides ball 1; ball 2 has moved and
/// is a guest.
template <int Dim>
struct Reach {
  Triangulation<Dim> t;
  ReachList<Dim> list;
};

template <int Dim>
std::string report_of(const Reach<Dim>& reach) {
  return report_of(reach.list.audit(reach.t));
}

template <int Dim>
Reach<Dim> some_reach() {
  Random random(2);
  auto cloud = make_cloud<Dim>(CloudKind::kUniform, kCount, random);
  cloud.x.col(1) = cloud.x.col(0);
  cloud.radius[1] = 0.1;
  Reach<Dim> reach;
  reach.t.build(cloud.x, cloud.radius.array().square());
  reach.list.build(reach.t, [&](int i) -> typename ReachList<Dim>::Ball {
    return {cloud.x.col(i), cloud.radius[i]};
  });
  // Into another one.
  reach.list.move(2, {cloud.x.col(30) + 0.3 * oblique<Dim>(), cloud.radius[2]});
  return reach;
}

/// Whose ball it is a guest of.
template <int Dim>
std::size_t host_of(const ReachList<Dim>& list, int ball) {
  const auto& first = Probe::first_guest(list);
  for (std::size_t site = 0; site < first.size(); ++site) {
    if (first[site] >= 0 &&
        Probe::guests(list)[static_cast<std::size_t>(first[site])].ball == ball) {
      return site;
    }
  }
  return first.size();
}

std::string not_listed(const std::string& what, const Pair& pair) {
  return what + " " + std::to_string(pair.i) + " and " + std::to_string(pair.j);
}

/// A near list of several blocks in a box.
template <int Dim>
struct Near {
  using List = NearList<Dim, FrictionalSpring::Memory<Dim>>;
  Cloud<Dim> cloud;
  std::vector<Wall<Dim>> walls;
  List list;
};

template <int Dim>
std::string report_of(const Near<Dim>& near) {
  return report_of(near.list.audit(near.cloud.radius, near.walls));
}

/// All grains have been centred, and one of them anew since.
template <int Dim>
Near<Dim> some_near() {
  Random random(3);
  Near<Dim> near{make_cloud<Dim>(CloudKind::kUniform, kCount, random), {}, {}};
  near.cloud.x *= 0.8;
  const Vec<Dim> low = near.cloud.x.rowwise().minCoeff();
  const Vec<Dim> high = near.cloud.x.rowwise().maxCoeff();
  near.walls = box<Dim>(low, high);
  near.walls[0].velocity = 0.1 * Vec<Dim>::Unit(0);
  CellGrid<Dim> cells;
  const auto velocity = [](int i) -> Vec<Dim> { return 0.1 * (i % 3) * oblique<Dim>(); };
  near.list.reset(kCount, 16);
  near.list.refresh(near.cloud.x, near.cloud.radius, velocity, near.walls, cells, 0, 0.001, 0);
  near.cloud.x.col(kVisible) += 0.5 * oblique<Dim>();
  std::vector<int> strays{kVisible};
  REQUIRE(near.list.amend(
      strays, [&](int i) -> Vec<Dim> { return near.cloud.x.col(i); }, velocity, near.cloud.radius,
      near.walls, cells, 0, 0.001));
  return near;
}

/// A neighbourhood, and its answer to a question.
template <int Dim>
struct Followed {
  Cloud<Dim> cloud;
  TriangulationNeighbourhood<Dim> neighbourhood;
  Eigen::VectorXd margin;

  void ask() {
    margin = 0.01 * cloud.radius;
    std::vector<Pair> pairs;
    neighbourhood.near_pairs(cloud.x, cloud.radius, margin, pairs);
  }
};

template <int Dim>
std::string report_of(const Followed<Dim>& f) {
  const auto place = [&](int i) -> Vec<Dim> { return f.cloud.x.col(i); };
  return report_of(f.neighbourhood.audit(f.cloud.radius, all_ids(kCount), place, f.margin));
}

/// T follows the grains, which have moved a little.
template <int Dim>
Followed<Dim> following(CloudKind kind, double room) {
  Random random(4);
  Followed<Dim> followed{make_cloud<Dim>(kind, kCount, random),
                         TriangulationNeighbourhood<Dim>(Laziness{.leap = false}),
                         {}};
  followed.cloud.x *= room;
  followed.ask();
  for (int i = 0; i < kCount; ++i) followed.cloud.x.col(i) += 0.2 * random_direction<Dim>(random);
  followed.ask();
  return followed;
}

/// T has leapt, and grains have left their skins since.
template <int Dim>
Followed<Dim> leaping() {
  Random random(5);
  Followed<Dim> followed{make_cloud<Dim>(CloudKind::kUniform, kCount, random), {}, {}};
  followed.ask();
  Probe::spent(followed.neighbourhood) = std::numeric_limits<int>::max();
  followed.ask();
  for (int i = 0; i < 5; ++i) followed.cloud.x.col(i) += 3 * oblique<Dim>();
  followed.ask();
  REQUIRE(Probe::leaping(followed.neighbourhood));
  return followed;
}

// ---- Planting ----------------------------------------------------------------------------------

void check_names(const std::string& report, const std::string& error) {
  CHECK(doctest::String(report.c_str()) == doctest::Contains(error.c_str()));
}

/// An audit finds nothing wrong, and after the planting the error.
/// @param kept  T, a list with what it is audited against, or a neighbourhood with its answer
template <class Kept, class Plant>
void check_found(Kept kept, const std::string& error, Plant&& plant) {
  REQUIRE(report_of(kept) == "");
  if constexpr (requires { kept.list; }) {
    plant(kept.list);
  } else {
    plant(kept);
  }
  check_names(report_of(kept), error);
}

/// Errors in what is kept of a set that does not span all dimensions.
template <int Dim>
void check_flat_set(const Triangulation<Dim>& t) {
  const Edge none = no_edge(t);
  check_found(t, "the list of edges is out of date",
              [](auto& u) { Probe::listed(Probe::edges(u)).pop_back(); });
  check_found(t, "the list of edges is out of date",
              [&](auto& u) { Probe::edges(u).note_made(none.first, none.second); });
  for (const int more : {-1, 1}) {
    check_found(t, "the dimension is wrong", [&](auto& u) { Probe::dimension(u) += more; });
  }
  check_found(t, "the corner of the site belongs to another", [](auto& u) {
    // Of the first auxiliary site.
    Probe::topology(u).set_corner_of(u.size(), Probe::topology(u).corner_of(0));
  });
}

}  // namespace

TEST_SUITE("planted_errors") {
  TEST_CASE_TEMPLATE("T: edges that are missing, too many or listed twice", S, Space<2>, Space<3>) {
    const auto t = some_triangulation<S::Dim>();
    const std::string error = "the list of edges is out of date";
    const Edge edge = edges(t)[7], none = no_edge(t);

    // Noted wrongly, and wrong already.
    check_found(t, error, [&](auto& u) { Probe::edges(u).note_gone(edge.first, edge.second); });
    check_found(t, error, [&](auto& u) { Probe::edges(u).note_made(edge.first, edge.second); });
    check_found(t, error, [&](auto& u) { Probe::edges(u).note_made(none.first, none.second); });
    check_found(t, error, [&](auto& u) { Probe::listed(Probe::edges(u)).pop_back(); });
    check_found(t, error, [&](auto& u) {
      auto& list = Probe::listed(Probe::edges(u));
      list.insert(list.begin() + 7, list[7]);
    });
    check_found(t, error, [&](auto& u) {
      auto& list = Probe::listed(Probe::edges(u));
      std::swap(list[7], list[8]);
    });
    check_found(t, "the list of edges knows nothing of updates",
                [](auto& u) { Probe::live(Probe::edges(u)) = false; });
  }

  TEST_CASE_TEMPLATE("T: a new edge that an update does not tell", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    auto t = some_triangulation<Dim>();
    Columns<Dim> x(Dim, kCount);
    Eigen::VectorXd w(kCount);
    for (int i = 0; i < kCount; ++i) {
      x.col(i) = t.site(i);
      w[i] = t.weight(i);
    }
    x.col(kVisible) += oblique<Dim>();
    const std::vector<EdgeList::Edge> old(t.edges().begin(), t.edges().end());
    t.move(std::vector<int>{kVisible}, x, w);
    REQUIRE(!Probe::notes(Probe::edges(t)).empty());
    Probe::before(Probe::edges(t)) = old;  // as remember() keeps them

    check_found(t, "an edge is not told to be new", [&](auto& u) {
      Probe::first_new(Probe::edges(u)) = Probe::notes(Probe::edges(u)).size();
    });
  }

  TEST_CASE("edges: one that is new and not told, or not listed") {
    EdgeList list, found;
    list.find(4, [](auto&& f) { f(0, 1), f(1, 2), f(2, 3); });
    found.find(4, [](auto&& f) { f(0, 1), f(1, 2), f(2, 3), f(0, 3); });
    list.begin_update();
    list.remember();
    CHECK(list.audit(found) == "the list of edges is out of date");
    list.note_made(0, 3);
    CHECK(list.audit(found) == "");

    Probe::notes(list).clear();
    Probe::listed(list) = Probe::listed(found);
    std::vector<EdgeList::Edge> told;
    list.for_each_new([&](int i, int j) { told.push_back({i, j}); });
    REQUIRE(told.empty());

    CHECK(list.audit(found) == "an edge is not told to be new");
  }

  TEST_CASE_TEMPLATE(
      "T: the corner of a site, or of infinity, is in another simplex, in one that "
      "is dead, or nowhere",
      S, Space<2>, Space<3>) {
    const auto t = some_triangulation<S::Dim>();
    const auto& topology = Probe::topology(t);
    const std::string error = "the corner of the site belongs to another";
    const int other = topology.corner_of(kVisible + 1);
    const int dead = 4 * dead_simplex(t), beyond = 4 * topology.slots();

    for (const int id : {kVisible, topology.kInfinite}) {
      for (const int corner : {other, dead, beyond}) {
        check_found(t, error, [&](auto& u) { Probe::topology(u).set_corner_of(id, corner); });
      }
    }
    check_found(t, error, [&](auto& u) { Probe::topology(u).set_corner_of(-1, -1); });
    check_found(t, S::Dim == 2 ? "a vertex of the triangle" : "a vertex of the tetrahedron",
                [&](auto& u) { Probe::topology(u).set_corner_of(kVisible, -1); });
    check_found(t, "the number of present sites is wrong",
                [&](auto& u) { Probe::topology(u).set_corner_of(kVisible, -1); });
  }

  TEST_CASE_TEMPLATE("T: the list of hidden sites, and the number of those that are present", S,
                     Space<2>, Space<3>) {
    const auto t = some_triangulation<S::Dim>();
    REQUIRE(hidden(t) == std::vector<int>{kHiddenFirst, kHiddenNext});
    const std::string error = "the list of hidden sites is wrong";

    check_found(t, error, [](auto& u) { Probe::hidden(u).pop_back(); });
    check_found(t, error, [](auto& u) { Probe::hidden(u).push_back(kVisible); });
    check_found(t, error, [](auto& u) { Probe::hidden(u).push_back(kHiddenNext); });
    check_found(t, error, [](auto& u) { std::swap(Probe::hidden(u)[0], Probe::hidden(u)[1]); });
    check_found(t, "the number of present sites is wrong", [](auto& u) { ++Probe::present(u); });
    check_found(t, "the hidden site has a cell",
                [](auto& u) { change_unseen(u, kHiddenNext, [](auto& site) { site.w = 2; }); });
  }

  TEST_CASE_TEMPLATE("T: hints of hidden sites that go round in a circle or out of range", S,
                     Space<2>, Space<3>) {
    auto t = some_triangulation<S::Dim>();
    const std::string error = "the hints of the hidden site lead nowhere";
    const auto hint = [](auto& u, int id, int at) {
      Probe::topology(u).set_corner_of(id, -2 - at);
    };

    check_found(t, error, [&](auto& u) { hint(u, kHiddenFirst, kHiddenFirst); });
    check_found(t, error, [&](auto& u) {
      hint(u, kHiddenFirst, kHiddenNext);
      hint(u, kHiddenNext, kHiddenFirst);
    });
    check_found(t, error, [&](auto& u) { hint(u, kHiddenFirst, kCount); });
    // To one that has been removed, and over another hidden one: both are legal.
    hint(t, kHiddenFirst, kAbsent);
    CHECK(report_of(t) == "");
    hint(t, kHiddenNext, kHiddenFirst);
    CHECK(report_of(t) == "");
  }

  TEST_CASE_TEMPLATE("T: flags, marks and notes that an update has left", S, Space<2>, Space<3>) {
    const auto t = some_triangulation<S::Dim>();
    const std::string simplex = "a flag or mark is left from an update";
    const std::string site = "a note of a site is left from an update";
    const int some = finite_simplex(t);

    check_found(t, simplex, [&](auto& u) { Probe::topology(u).exchange_flag(4 * some + 1, true); });
    check_found(t, simplex, [&](auto& u) { Probe::mark(u, some) += 1000; });
    check_found(t, site, [](auto& u) { Probe::site_note(u)[0] = 1; });
    if constexpr (S::Dim == 3) {
      // What counts edges uses these notes.
      check_found(t, "Euler's relation fails", [](auto& u) { Probe::vertex_note(u)[0] = 1; });
    }
  }

  TEST_CASE_TEMPLATE("T: slots that are free, and where the next search begins", S, Space<2>,
                     Space<3>) {
    const auto t = some_triangulation<S::Dim>();
    const std::string error = "the list of free slots is wrong";
    REQUIRE(Probe::topology(t).free_slots().size() > 1);

    check_found(t, error, [](auto& u) { Probe::free_slots(u).back() = finite_simplex(u); });
    check_found(t, error, [](auto& u) { Probe::free_slots(u).pop_back(); });
    check_found(t, error, [](auto& u) { Probe::free_slots(u)[0] = Probe::free_slots(u)[1]; });
    for (const int site : {-1, kCount + 1}) {
      check_found(t, "the search for the next site begins nowhere",
                  [&](auto& u) { Probe::last(u) = site; });
    }
  }

  TEST_CASE_TEMPLATE("T: the second copy of a place or weight, and the dimension", S, Space<2>,
                     Space<3>) {
    const auto t = some_triangulation<S::Dim>();
    const std::string error = "two copies of the place differ";

    check_found(t, error, [](auto& u) { Probe::places_before(u)[0].y += 1e-9; });
    check_found(t, error, [](auto& u) { Probe::places_before(u)[0].w += 1e-9; });
    for (const int more : {-1, 1}) {
      check_found(t, "the dimension is wrong", [&](auto& u) { Probe::dimension(u) += more; });
    }
  }

  TEST_CASE_TEMPLATE("T: neighbours that do not know each other", S, Space<2>, Space<3>) {
    const auto t = some_triangulation<S::Dim>();
    const std::string error = "two neighbours do not share their";
    const int one = 4 * finite_simplex(t), other = 4 * finite_simplex(t, 20);

    check_found(t, error, [&](auto& u) { Probe::topology(u).link(one, other); });
    check_found(t, error, [&](auto& u) {
      // Two neighbours of one simplex change places.
      auto& topology = Probe::topology(u);
      const int first = topology.twin(one), second = topology.twin(one + 1);
      topology.link(one, second);
      topology.link(one + 1, first);
    });
  }

  TEST_CASE_TEMPLATE("T: a site that moves, or grows, unseen", S, Space<2>, Space<3>) {
    const auto t = some_triangulation<S::Dim>();

    check_found(
        t,
        S::Dim == 2 ? "the triangle is not counter-clockwise" : "the tetrahedron is not positive",
        [](auto& u) {
          // To where another one is.
          const auto other = Probe::sites(u)[40];
          change_unseen(u, kVisible, [&](auto& site) { site = other; });
        });
    check_found(t, "is not locally regular",
                [](auto& u) { change_unseen(u, kVisible, [](auto& site) { site.w += 3; }); });
  }

  TEST_CASE_TEMPLATE("T: two simplices beside the others", S, Space<2>, Space<3>) {
    check_found(some_triangulation<S::Dim>(), "Euler's relation fails", [](auto& u) {
      // Back to back; the sites keep the corners that they have.
      auto& topology = Probe::topology(u);
      const int some = finite_simplex(u);
      const auto old = topology.vertices(some);
      std::vector<std::pair<int, int>> corners{{-1, topology.corner_of(-1)}};
      for (const int id : old) corners.emplace_back(id, topology.corner_of(id));
      if constexpr (S::Dim == 2) {
        const int a = old[0], b = old[1];
        const int front = topology.add(-1, a, b), back = topology.add(-1, b, a);
        topology.link(4 * front, 4 * back);
        topology.link(4 * front + 1, 4 * back + 2);
        topology.link(4 * front + 2, 4 * back + 1);
      } else {
        const int a = old[0], b = old[1], c = old[2];
        const int front = topology.add({-1, a, b, c}), back = topology.add({-1, b, a, c});
        topology.link(4 * front, 4 * back);
        topology.link(4 * front + 1, 4 * back + 2);
        topology.link(4 * front + 2, 4 * back + 1);
        topology.link(4 * front + 3, 4 * back + 3);
      }
      for (const auto& [id, corner] : corners) topology.set_corner_of(id, corner);
    });
  }

  TEST_CASE_TEMPLATE("T: positive simplices that go round twice", S, Space<2>, Space<3>) {
    CHECK(report_of(fan<S::Dim>(1)) == "");
    check_names(report_of(fan<S::Dim>(2)), "the hull does not go round once");
  }

  TEST_CASE("T in space: the point in the middle") {
    const auto t = some_triangulation<3>();

    check_found(t, "the point in the middle lies outside the hull",
                [](auto& u) { Probe::middle(u).z += 1000; });
    check_found(t, "the point in the middle lies inside a hull that counts as thin",
                [](auto& u) { Probe::thin(u) = true; });
  }

  TEST_CASE_TEMPLATE("T: what is kept of sites on a line", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    SiteSet<Dim> line{"line", Columns<Dim>(Dim, 8), Eigen::VectorXd(8)};
    for (int k = 0; k < 8; ++k) {
      for (int axis = 0; axis < Dim; ++axis) line.x(axis, k) = (axis + 1) * k;
      line.w[k] = k == 4 ? -30 : 0.1 * k;
    }
    const auto t = built(line);
    REQUIRE(t.dimension() == 1);
    REQUIRE(hidden(t) == std::vector<int>{4});

    check_flat_set(t);
    check_found(t, "the hints of the hidden site lead nowhere",
                [](auto& u) { Probe::topology(u).set_corner_of(4, -2 - 4); });
    check_found(t, "the hidden site has a cell",
                [](auto& u) { change_unseen(u, 4, [](auto& site) { site.w = 0.4; }); });
    check_found(t, "the dimension is wrong",
                [](auto& u) { change_unseen(u, 2, [](auto& site) { site.y += 1e-9; }); });
  }

  TEST_CASE("T: what is kept of sites in a plane in space") {
    Rows<3> plane{{0.1, 0.1, 0, 0}};
    for (int k = 0; k < 5; ++k) {
      const double angle = 2 * std::numbers::pi * k / 5;
      plane.push_back({std::cos(angle), std::sin(angle), 0, 0});
    }
    const auto t = built(site_set<3>("plane", plane, 1));
    REQUIRE(t.dimension() == 2);

    check_flat_set(t);
    // Away from the auxiliary site, so that all simplices stay as they are.
    check_found(t, "the dimension is wrong",
                [](auto& u) { change_unseen(u, 0, [](auto& site) { site.z = -1e-3; }); });
  }

  TEST_CASE_TEMPLATE("reach list: pairs and partners", S, Space<2>, Space<3>) {
    const auto reach = some_reach<S::Dim>();
    REQUIRE(reach.list.pairs().size() > 20);
    REQUIRE(!reach.list.added().empty());
    const std::string partners = "partners are not those of the pairs";
    const Pair listed = reach.list.pairs()[9], added = reach.list.added().back();

    check_found(reach, not_listed("balls", listed),
                [](auto& list) { Probe::pairs(list).erase(Probe::pairs(list).begin() + 9); });
    check_found(reach, not_listed("balls", added),
                [](auto& list) { Probe::added(list).pop_back(); });
    check_found(reach, partners,
                [](auto& list) { Probe::pairs(list).erase(Probe::pairs(list).begin() + 9); });
    check_found(reach, partners, [](auto& list) { Probe::more(list)[2].pop_back(); });
    check_found(reach, partners, [](auto& list) { ++Probe::partners(list)[7]; });
    check_found(reach, partners, [&](auto& list) {
      // The last partner of one ball becomes the first of the next.
      --Probe::first(list)[static_cast<std::size_t>(listed.i) + 1];
    });
    check_found(reach, partners, [&](auto& list) {
      // One end has the pair twice, the other not at all.
      auto& more = Probe::more(list);
      const auto i = static_cast<std::size_t>(added.i), j = static_cast<std::size_t>(added.j);
      std::erase(more[i], added.j);
      more[j].push_back(added.i);
    });
    check_found(reach, "a pair is listed twice",
                [&](auto& list) { Probe::added(list).push_back(listed); });
    check_found(reach, "pairs are not sorted",
                [](auto& list) { std::swap(Probe::pairs(list)[3], Probe::pairs(list)[4]); });
    check_found(reach, "meet and are not listed", [](auto& list) {
      // Somewhere else, and nobody knows.
      Probe::balls(list)[20].centre = Probe::balls(list)[40].centre;
    });
  }

  TEST_CASE_TEMPLATE("reach list: what walks stand on", S, Space<2>, Space<3>) {
    const auto reach = some_reach<S::Dim>();
    REQUIRE(hidden(reach.t) == std::vector<int>{1});
    const std::size_t host = host_of(reach.list, 2);
    REQUIRE(host < static_cast<std::size_t>(kCount));
    const std::string edge = "the edges are not those of T";
    const std::string nobody = "ball 2 is nobody's guest";

    check_found(reach, edge, [](auto& list) { ++Probe::edge_ends(list)[5]; });
    check_found(reach, edge, [](auto& list) { ++Probe::first_edge(list)[5]; });
    check_found(reach, edge, [](auto& list) { Probe::edge_ends(list).pop_back(); });
    check_found(reach, "site 2 is not that of T",
                [](auto& list) { Probe::sites(list)[2].centre *= 2; });
    check_found(reach, "site 9 is not that of T", [](auto& list) {
      Probe::sites(list)[9].radius *= 0.5;
      Probe::balls(list)[9] = Probe::sites(list)[9];
    });
    check_found(reach, "the parts of the list do not fit together",
                [](auto& list) { Probe::apart(list)[0] = kCount; });
    check_found(reach, "the parts of the list do not fit together",
                [](auto& list) { Probe::stamps(list).pop_back(); });
    check_found(reach, "guests are lost", [&](auto& list) { Probe::first_guest(list)[host] = -1; });
    check_found(reach, nobody, [&](auto& list) { Probe::first_guest(list)[host] = -1; });
    check_found(reach, "guests are lost", [&](auto& list) {
      // A chain without an end.
      Probe::guests(list)[0].next = 0;
    });
    check_found(reach, nobody, [&](auto& list) {
      // With a site that is far away.
      const auto& balls = Probe::balls(list);
      std::size_t far = 0;
      while ((balls[far].centre - balls[2].centre).norm() < 5) ++far;
      std::swap(Probe::first_guest(list)[host], Probe::first_guest(list)[far]);
    });
    check_found(reach, nobody, [](auto& list) { Probe::widest(list) = 0; });
    check_found(reach, "a hidden ball is not compared with all others",
                [](auto& list) { Probe::apart(list).clear(); });
    check_found(reach, "a stamp is ahead of its time",
                [](auto& list) { Probe::stamps(list)[0] = Probe::stamp(list) + 1; });
  }

  TEST_CASE_TEMPLATE("near list: pairs, within a block and across", S, Space<2>, Space<3>) {
    const auto near = some_near<S::Dim>();
    const auto& block = near.list.blocks()[0];
    REQUIRE(block.within.size() > 3);
    REQUIRE(block.across.size() > 3);
    const Pair within = block.within.pairs()[0];
    const std::string unsound = "block 0 is not sound";
    const auto erase_pair = [](auto& table) {
      auto pairs = table.pairs();
      pairs.erase(pairs.begin());
      table.replace(pairs);
    };

    check_found(near, not_listed("slots", within),
                [&](auto& list) { erase_pair(list.blocks()[0].within); });
    check_found(near, "are within reach and not listed", [&](auto& list) {
      for (auto& at : list.blocks()) {
        std::vector<Pair> none;
        at.across.replace(none);
        at.ends.clear();
        at.first_across = 0;
      }
      Probe::across_count(list) = 0;
    });
    check_found(near, "the ends of block 0 are out of date",
                [&](auto& list) { erase_pair(list.blocks()[0].across); });
    check_found(near, "the ends of block 1 are out of date",
                [](auto& list) { list.blocks()[1].ends.pop_back(); });
    check_found(near, "the ends of block 1 are out of date",
                [](auto& list) { ++list.blocks()[1].ends[0].partner; });
    check_found(near, "the ends of block 1 are out of date",
                [](auto& list) { ++list.blocks()[1].first_across; });
    check_found(near, "block 1 is not sound", [](auto& list) { --Probe::block_size(list); });
    check_found(near, "blocks do not share out the slots",
                [](auto& list) { --list.blocks().back().end_slot; });
    check_found(near, "the number of pairs across is wrong",
                [](auto& list) { ++Probe::across_count(list); });
    check_found(near, unsound, [](auto& list) {
      auto& pairs = Probe::pairs_of_table(list.blocks()[0].within);
      std::swap(pairs[0], pairs[1]);
    });
    check_found(near, unsound, [](auto& list) {
      auto& pairs = Probe::pairs_of_table(list.blocks()[0].across);
      pairs[1] = pairs[0];
    });
    check_found(near, unsound,
                [](auto& list) { Probe::memory(list.blocks()[0].across)[1].pop_back(); });
    check_found(near, unsound, [](auto& list) {
      list.blocks()[0].within.insert({0, kCount - 1});  // of another block
    });
  }

  TEST_CASE_TEMPLATE("near list: margins and walls", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const auto near = some_near<Dim>();
    const std::string listed = "are within reach and not listed";

    check_found(near, "slot 4 stays within another margin",
                [](auto& list) { Probe::margin(list)[4] *= 2; });
    check_found(near, "slot 4 stays within another margin",
                [](auto& list) { Probe::stays(list)[4].squared_margin *= 2; });
    check_found(near, listed, [](auto& list) {
      // Wider than it was listed with; a hair less counts.
      const double hair = std::sqrt(Probe::stays(list)[4].squared_margin) / Probe::margin(list)[4];
      Probe::margin(list)[4] = 3;
      Probe::stays(list)[4].squared_margin = std::pow(3 * hair, 2);
    });
    check_found(near, listed,
                [](auto& list) { Probe::stays(list)[4].centre = Probe::stays(list)[44].centre; });

    std::size_t b = 0;
    while (near.list.blocks()[b].walls.size() == 0) ++b;
    const WallPair first = near.list.blocks()[b].walls.pairs()[0];
    check_found(near, "slot " + std::to_string(first.i) + " and wall ", [&](auto& list) {
      auto& table = list.blocks()[b].walls;
      auto pairs = table.pairs();
      pairs.erase(pairs.begin());
      table.replace(pairs);
    });
    check_found(near, "and wall low are within reach",
                [](auto& list) { Probe::wall_margin(list)[0] += 1; });
    check_found(near, "and wall low are within reach",
                [](auto& list) { Probe::listed_walls(list)[0].point += 2 * Vec<Dim>::Unit(0); });
    check_found(near, "block " + std::to_string(b) + " is not sound", [&](auto& list) {
      list.blocks()[b].walls.insert({first.i, static_cast<int>(near.walls.size())});
    });
    check_found(near, "block " + std::to_string(b) + " is not sound", [&](auto& list) {
      list.blocks()[b].walls.insert({first.i, first.wall, 1});  // a half-space has one piece
    });
    check_found(near, "the parts of the list do not fit together",
                [](auto& list) { Probe::listed_walls(list).pop_back(); });
    check_found(near, "block " + std::to_string(b) + " is not sound",
                [&](auto& list) { Probe::memory(list.blocks()[b].walls)[0].push_back(0); });
  }

  TEST_CASE_TEMPLATE("following: skins and references", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const auto followed = following<Dim>(CloudKind::kLattice, 1.3);
    REQUIRE(Probe::uncertain(followed.neighbourhood).empty());
    const std::string unsound = "the reference of grain 7 is not sound";
    const auto widen = [](auto& f, double factor) {
      auto& n = f.neighbourhood;
      Probe::skin(n)[7] *= factor;
      Probe::weight(n)[7] = std::pow(f.cloud.radius[7] + Probe::skin(n)[7], 2);
    };

    check_found(followed, unsound, [](auto& f) { Probe::skin(f.neighbourhood)[7] *= 1.01; });
    check_found(followed, unsound, [](auto& f) { Probe::weight(f.neighbourhood)[7] *= 1.01; });
    check_found(followed, unsound, [&](auto& f) { widen(f, 1.01); });
    check_found(followed, unsound,
                [](auto& f) { Probe::reference(f.neighbourhood)(0, 7) += 1e-6; });
    check_found(followed, unsound, [](auto& f) { Probe::mark_as_waiting(f.neighbourhood, 7); });
    check_found(followed, "grains wait for new references",
                [](auto& f) { Probe::join(f.neighbourhood, 7); });
    check_found(followed, "grain 7 has a margin beyond its skin",
                [](auto& f) { f.margin[7] = 1.01 * Probe::skin(f.neighbourhood)[7]; });
    check_found(followed, "has a margin beyond its skin", [](auto& f) {
      Probe::drift(f.neighbourhood) += 2 * f.cloud.radius[0] * oblique<Dim>();
    });
    check_found(followed, "T: the list of edges is out of date", [](auto& f) {
      auto& t = Probe::triangulation(f.neighbourhood);
      Probe::edges(t).note_gone(t.edges()[0][0], t.edges()[0][1]);
    });
    check_found(followed, "fails unseen", [&](auto& f) {
      // T learns of the wide skin, but nobody asks whether its edges pass.
      widen(f, 20);
      auto& n = f.neighbourhood;
      Probe::triangulation(n).move(std::vector<int>{7}, Probe::reference(n), Probe::weight(n));
    });
  }

  TEST_CASE_TEMPLATE("following: grains whose pairs T may lack", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const auto followed = following<Dim>(CloudKind::kCoincident, 0.6);
    REQUIRE(!followed.neighbourhood.triangulation().hidden().empty());
    const auto forget = [](auto& f) { Probe::uncertain(f.neighbourhood).clear(); };

    check_found(followed, "fails unseen", forget);
    check_found(followed, "is hidden unseen", forget);
    check_found(followed, "what is uncertain is no grain",
                [](auto& f) { Probe::uncertain(f.neighbourhood).push_back(kCount); });
    check_found(followed, "meet and are no edge", forget);
    const int hidden = followed.neighbourhood.triangulation().hidden()[0];
    check_found(followed, "grain " + std::to_string(hidden) + " is hidden unseen",
                [&](auto& f) { std::erase(Probe::uncertain(f.neighbourhood), hidden); });
  }

  TEST_CASE_TEMPLATE("leaping: what is kept for walks", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const auto followed = leaping<Dim>();
    REQUIRE(followed.neighbourhood.cost().walks > 0);

    check_found(followed, "walks: partners are not those of the pairs",
                [](auto& f) { Probe::pairs(Probe::reach(f.neighbourhood)).pop_back(); });
    check_found(followed, "walks: the edges are not those of T",
                [](auto& f) { ++Probe::edge_ends(Probe::reach(f.neighbourhood))[0]; });
    const std::string unsound = "the reference of grain 7 is not sound";
    check_found(followed, unsound, [](auto& f) { Probe::weight(f.neighbourhood)[7] *= 1.01; });
    check_found(followed, unsound, [](auto& f) {
      auto& n = f.neighbourhood;
      Probe::skin(n)[7] *= 5;
      Probe::weight(n)[7] = std::pow(f.cloud.radius[7] + Probe::skin(n)[7], 2);
    });
    check_found(followed, unsound,
                [](auto& f) { Probe::reference(f.neighbourhood)(0, 7) += 1e-6; });
    check_found(followed, "grain 7 has a margin beyond its skin",
                [](auto& f) { f.margin[7] = 1.01 * Probe::skin(f.neighbourhood)[7]; });
    check_found(followed, "fails unseen", [](auto& f) { Probe::leaping(f.neighbourhood) = false; });
    check_found(followed, "T: a flag or mark is left from an update", [](auto& f) {
      auto& t = Probe::triangulation(f.neighbourhood);
      Probe::topology(t).exchange_flag(4 * finite_simplex(t), true);
    });
  }

  TEST_CASE_TEMPLATE("no sites, one and none any more: there is nothing wrong", S, Space<2>,
                     Space<3>) {
    Triangulation<S::Dim> t;
    CHECK(report_of(t) == "");
    t.insert(0, oblique<S::Dim>(), 1);
    CHECK(report_of(t) == "");
    t.remove(0);
    CHECK(report_of(t) == "");
    auto many = some_triangulation<S::Dim>();
    many.build(Columns<S::Dim>(S::Dim, 0), Eigen::VectorXd(0));
    CHECK(report_of(many) == "");
  }

  TEST_CASE_TEMPLATE("builds that audit every update throw what they find", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const auto throws = [](auto&& f) {
      try {
        f();
      } catch (const AuditError&) {
        return true;
      }
      return false;
    };
    auto t = some_triangulation<Dim>();
    auto near = some_near<Dim>();
    auto followed = leaping<Dim>();
    CellGrid<Dim> cells;
    std::vector<int> none;
    const auto place = [&](int i) -> Vec<Dim> { return near.cloud.x.col(i); };
    const auto velocity = [](int) -> Vec<Dim> { return Vec<Dim>::Zero(); };
    const auto amend = [&] {
      near.list.amend(none, place, velocity, near.cloud.radius, near.walls, cells, 0, 0.001);
    };
    CHECK_FALSE(throws([&] { update(t); }));
    CHECK_FALSE(throws(amend));
    CHECK_FALSE(throws([&] { followed.ask(); }));

    Probe::edges(t).note_gone(t.edges()[0][0], t.edges()[0][1]);
    Probe::margin(near.list)[4] *= 2;
    Probe::weight(followed.neighbourhood)[7] *= 1.01;

    CHECK(throws([&] { update(t); }) == kAudited);
    CHECK(throws(amend) == kAudited);
    CHECK(throws([&] { followed.ask(); }) == kAudited);
  }
}
