// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/files.hpp>
#include <lagrain/scene.hpp>

#include "placing.hpp"
#include "scene_keys.hpp"
#include "settings.hpp"
#include "stl.hpp"
#include "toml_table.hpp"

#include <lagrain/numbers.hpp>
#include <lagrain/words.hpp>

#include <charconv>
#include <cmath>
#include <initializer_list>
#include <numeric>
#include <stdexcept>

namespace lagrain {
namespace {

using detail::Key;
using detail::TomlFile;
using detail::TomlTable;
namespace keys = detail::keys;

constexpr int kMostGrains = 100'000'000;
constexpr int kMostSlices = 1000;            // each is several columns of the series
constexpr std::size_t kMostMaterials = 255;  // a grain keeps its material in one byte

/// The number before `contact`: "1/25" or "0.04".
std::optional<double> fraction_in(std::string_view text) {
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  double parts[2] = {0, 1};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int k = 0; k < 2; ++k) {
    const auto [stop, failure] = std::from_chars(at, end, parts[k]);
    if (failure != std::errc{}) return {};
    at = stop;
    if (at == end) break;
    if (k == 1 || *at != '/') return {};
    ++at;
  }
  const double fraction = parts[0] / parts[1];
  if (!std::isfinite(fraction) || fraction <= 0) return {};
  return fraction;
}

bool is_time(const std::string& text) {
  try {
    return parse_quantity(text).unit == detail::kTime.unit;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

/// A time, or a fraction of the shortest contact time.
TimeStep read_time_step(TomlTable& top) {
  const Key& key = keys::kTimeStep;
  const std::string what = "a fraction of contact time (\"1/25 contact\") or a time";
  TimeStep step;
  if (!top.has(key)) return step;
  if (top.holds_text(key)) {
    const std::string whole = top.text(key);
    constexpr std::string_view kUnit = "contact";
    if (whole.ends_with(kUnit)) {
      const auto fraction =
          fraction_in(std::string_view(whole).substr(0, whole.size() - kUnit.size()));
      if (!fraction) top.expected(key, what);
      step.fraction_of_contact = *fraction;
      return step;
    }
    if (!is_time(whole)) top.expected(key, what);
  } else if (!top.holds_number(key)) {
    top.expected(key, what);
  }
  step.seconds = top.number(key);
  return step;
}

/// Reads the numbers that a law is made from. With `base`, none is required and the missing ones
/// are taken from there.
void read_numbers(TomlTable& s, int dimension, std::span<const LawKey> law_keys,
                  const LawNumbers* base, LawNumbers& numbers) {
  for (const LawKey& law_key : law_keys) {
    const Key key = detail::key_of(law_key);
    if (law_key.in_space_only && dimension == 2) {
      s.refuse(key, "there is no such motion in the plane; remove this line");
      continue;
    }
    double& number = numbers.*law_key.number;
    if (base != nullptr) {
      number = s.number(key, number);
    } else if (law_key.fallback) {
      number = s.number(key, *law_key.fallback);
    } else {
      number = s.number(key);
    }
  }
}

/// Refuses the keys that other laws of a list use and this one does not.
/// @param choice  the key by which the scene chose the law
void refuse_unused(TomlTable& s, const Key& choice, const LawDescription& chosen,
                   std::span<const LawDescription> laws) {
  const auto uses = [](const LawDescription& law, std::string_view name) {
    return std::any_of(law.keys.begin(), law.keys.end(),
                       [&](const LawKey& key) { return key.name == name; });
  };
  for (const LawDescription& law : laws) {
    for (const LawKey& key : law.keys) {
      if (uses(chosen, key.name)) continue;
      std::string users;
      for (const LawDescription& other : laws) {
        if (!uses(other, key.name)) continue;
        users += (users.empty() ? "\"" : " or \"") + std::string(other.word) + "\"";
      }
      s.refuse(detail::key_of(key), std::string(choice.name) + " = \"" + std::string(chosen.word) +
                                        "\" does not use it; remove this line or choose " + users);
    }
  }
}

LawNumbers read_law(TomlTable& s, int dimension, NormalModel normal, FrictionModel friction,
                    const LawNumbers* base) {
  LawNumbers numbers = base != nullptr ? *base : LawNumbers{};
  read_numbers(s, dimension, description_of(normal).keys, base, numbers);
  read_numbers(s, dimension, description_of(friction).keys, base, numbers);
  refuse_unused(s, keys::kNormalLaw, description_of(normal), kNormalLaws);
  refuse_unused(s, keys::kFrictionLaw, description_of(friction), kFrictionLaws);
  return numbers;
}

/// The law that a key names.
template <class Model, std::size_t N>
Model law_word(TomlTable& s, const Key& key, const std::array<LawDescription, N>& laws) {
  std::vector<std::string_view> words;
  for (const LawDescription& law : laws) words.push_back(law.word);
  return static_cast<Model>(s.word(key, words));
}

RadiusLaw read_uniform_radius(TomlTable& s) {
  const auto bounds = s.numbers(keys::kUniform);
  if (bounds.size() != 2 || bounds[0] > bounds[1]) {
    s.expected(keys::kUniform, "[smallest, largest]");
  }
  for (const Key& key : {keys::kValues, keys::kSieves, keys::kPassing}) {
    s.refuse(key, "either uniform, or values, or sieves and passing");
  }
  s.refuse(keys::kWeights, "weights belong to values");
  return UniformRadius{bounds[0], bounds[1],
                       s.word<Share>(keys::kBy, detail::kShareWords, Share::number)};
}

RadiusLaw read_listed_radius(TomlTable& s) {
  ListedRadius listed;
  listed.values = s.numbers(keys::kValues);
  listed.weights = s.has(keys::kWeights) ? s.numbers(keys::kWeights)
                                         : std::vector<double>(listed.values.size(), 1.0);
  if (listed.weights.size() != listed.values.size() ||
      std::accumulate(listed.weights.begin(), listed.weights.end(), 0.0) <= 0) {
    s.fail(keys::kWeights, "expected as many weights as values, not all 0");
  }
  for (const Key& key : {keys::kSieves, keys::kPassing}) {
    s.refuse(key, "either values, or sieves and passing");
  }
  listed.by = s.word<Share>(keys::kBy, detail::kShareWords, listed.by);
  return listed;
}

RadiusLaw read_sieve_curve(TomlTable& s) {
  SieveCurve curve{s.numbers(keys::kSieves), s.numbers(keys::kPassing)};
  const auto& openings = curve.openings;
  const auto& passing = curve.passing;
  if (openings.size() < 2 || std::adjacent_find(openings.begin(), openings.end(),
                                                std::greater_equal<>()) != openings.end()) {
    s.expected(keys::kSieves, "the openings of two or more sieves, each wider than the one before");
  }
  if (passing.size() != openings.size() || passing.front() != 0 || passing.back() != 1 ||
      !std::is_sorted(passing.begin(), passing.end())) {
    s.expected(keys::kPassing, "as many shares as sieves, rising from 0 to 1");
  }
  s.refuse(keys::kWeights, "weights belong to values");
  s.refuse(keys::kBy, "what passes a sieve is a share of the mass; remove this line");
  return curve;
}

RadiusLaw read_radius(TomlTable& s) {
  if (!s.holds_table(keys::kRadius)) return s.number(keys::kRadius);
  TomlTable inner = s.table(keys::kRadius);
  RadiusLaw law;
  if (inner.has(keys::kUniform)) {
    law = read_uniform_radius(inner);
  } else if (inner.has(keys::kValues)) {
    law = read_listed_radius(inner);
  } else if (inner.has(keys::kSieves)) {
    law = read_sieve_curve(inner);
  } else {
    inner.finish();
    s.fail(keys::kRadius,
           "expected uniform = [low, high], values = [...], or sieves = [...] and passing = [...]");
  }
  inner.finish();
  return law;
}

template <int Dim>
class Reader {
 public:
  /// @param folder  from which the scene takes paths of files
  Reader(const toml::table& root, const std::string& name, std::filesystem::path folder)
      : file_{name, &scene_.lines}, folder_(std::move(folder)), top_(file_, root, "") {}

  Scene<Dim> read() {
    scene_.file = file_.name;
    read_top();
    read_drag();
    read_materials();
    read_laws();
    read_start();
    top_.for_each(keys::kFill, [&](TomlTable& s, int) { read_fill(s); });
    top_.for_each(keys::kGrain, [&](TomlTable& s, int) { read_grain(s); });
    top_.for_each(keys::kGrains, [&](TomlTable& s, int) { read_grain_file(s); });
    top_.for_each(keys::kInlet, [&](TomlTable& s, int) { read_inlet(s); });
    top_.for_each(keys::kOutlet, [&](TomlTable& s, int) { read_outlet(s); });
    read_domain();
    top_.for_each(keys::kWall, [&](TomlTable& s, int index) { read_wall(s, index); });
    top_.for_each(keys::kBox, [&](TomlTable& s, int) { read_box(s); });
    resolve_pressures();
    top_.for_each(keys::kMeasure, [&](TomlTable& s, int index) { read_measure(s, index); });
    read_output();
    top_.finish();
    if (scene_.fills.empty() && scene_.grains.empty() && scene_.grain_files.empty() &&
        scene_.inlets.empty() && !scene_.start) {
      throw SceneError(file_.name +
                       ": no grains: expected at least one [[fill]], [[grain]], "
                       "[[grains]], [[inlet]] or start");
    }
    return std::move(scene_);
  }

 private:
  void read_top() {
    top_.has(keys::kDimension);  // checked before this reader was chosen
    const std::string stem = std::filesystem::path(file_.name).stem().string();
    scene_.title = top_.text(keys::kTitle, stem);
    scene_.seed = static_cast<std::uint64_t>(
        top_.integer(keys::kSeed, 0, static_cast<std::int64_t>(scene_.seed)));
    scene_.duration = top_.number(keys::kDuration);
    scene_.time_step = read_time_step(top_);
    read_gravity();
    if (Dim == 2) {
      scene_.depth = top_.number(keys::kDepth, scene_.depth);
    } else {
      top_.refuse(keys::kDepth, "spheres have none; remove this line");
    }
    scene_.normal = law_word<NormalModel>(top_, keys::kNormalLaw, kNormalLaws);
    scene_.friction = law_word<FrictionModel>(top_, keys::kFrictionLaw, kFrictionLaws);
    scene_.integrator =
        top_.word<IntegratorModel>(keys::kIntegrator, detail::kIntegratorWords, scene_.integrator);
    if (!is_steady(scene_.gravity_course)) expect_no_fourth_order("gravity changes");
    scene_.neighbourhood = top_.word<NeighbourhoodModel>(
        keys::kNeighbourhood, detail::kNeighbourhoodWords, scene_.neighbourhood);
    scene_.largest_overlap = top_.number(keys::kLargestOverlap, scene_.largest_overlap);
    scene_.largest_initial_overlap =
        top_.number(keys::kLargestInitialOverlap, scene_.largest_initial_overlap);
    scene_.audit = top_.flag(keys::kAudit, scene_.audit);
    if (scene_.audit) {
      scene_.audit_every = static_cast<int>(top_.integer(keys::kAuditEvery, 1, scene_.audit_every));
    } else {
      top_.refuse(keys::kAuditEvery, "nothing is audited; add audit = true or remove this line");
    }
  }

  void read_gravity() {
    if (!top_.holds_table(keys::kGravity)) {
      scene_.gravity = top_.vector<Dim>(keys::kGravity);
      return;
    }
    TomlTable s = top_.table(keys::kGravity);
    if (s.has(keys::kTimes)) {
      const GravityTable<Dim> table{s.numbers(keys::kTimes), s.vectors<Dim>(keys::kGravityValues)};
      if (table.times.empty() || table.times.size() != table.gravity.size()) {
        s.fail(keys::kGravityValues, "expected one for each of the times");
      }
      for (std::size_t k = 1; k < table.times.size(); ++k) {
        if (table.times[k] < table.times[k - 1] ||
            (k > 1 && table.times[k] == table.times[k - 2])) {
          s.fail(keys::kTimes, "expected rising times, of which two may be equal: a switch");
        }
      }
      scene_.gravity_course = table;
      scene_.gravity = gravity_at(scene_.gravity_course, Vec<Dim>(Vec<Dim>::Zero()), 0);
    } else {
      scene_.gravity = s.vector<Dim>(keys::kGravityValue);
      TurningGravity<Dim> turning{read_axis(s), s.number(keys::kTurningRate)};
      read_times(s, turning);
      scene_.gravity_course = turning;
    }
    s.finish();
  }

  void read_drag() {
    if (!top_.has(keys::kDrag)) return;
    TomlTable s = top_.table(keys::kDrag);
    Drag<Dim> drag;
    if (Dim == 2) {
      s.refuse(keys::kViscosity, "Stokes' law is of spheres; in the plane give a rate");
    } else {
      drag.viscosity = s.number(keys::kViscosity, drag.viscosity);
    }
    drag.rate = s.number(keys::kDragRate, drag.rate);
    if (s.has(keys::kVelocity)) drag.flow = s.vector<Dim>(keys::kVelocity);
    if (!(drag.viscosity > 0 || drag.rate > 0)) {
      s.missing(keys::kDragRate, Dim == 2 ? "how fast velocities decay [1/s]"
                                          : "how fast velocities decay [1/s], or a viscosity");
    }
    s.finish();
    expect_no_fourth_order("drag takes energy");
    scene_.drag = drag;
  }

  void read_materials() {
    const auto none = [&] {
      return SceneError(file_.name +
                        ": materials: missing; expected at least one [materials.NAME]");
    };
    if (!top_.has(keys::kMaterials)) throw none();
    TomlTable all = top_.table(keys::kMaterials);
    const std::vector<std::string> names = all.names();
    if (names.empty()) throw none();
    if (names.size() > kMostMaterials) {
      top_.fail(keys::kMaterials, "expected at most " + std::to_string(kMostMaterials) + ", got " +
                                      std::to_string(names.size()));
    }
    for (const std::string& name : names) {
      TomlTable s = all.table(Key{name});
      scene_.materials.push_back({name, s.number(keys::kMaterialDensity, 0)});
      s.finish();
    }
  }

  int material_of(TomlTable& s, bool with_density) {
    const Key& key = keys::kMaterial;
    int found = 0;
    if (s.has(key) || scene_.materials.size() > 1) found = material_named(s.text(key), s, key);
    const Material& material = scene_.materials[static_cast<std::size_t>(found)];
    if (with_density && material.density == 0) {
      s.fail(key,
             "grains of \"" + material.name + "\" need [materials." + material.name + "] density");
    }
    return found;
  }
  int material_named(const std::string& name, TomlTable& s, const Key& key) {
    std::vector<std::string> names;
    for (std::size_t m = 0; m < scene_.materials.size(); ++m) {
      if (scene_.materials[m].name == name) return static_cast<int>(m);
      names.push_back(scene_.materials[m].name);
    }
    s.fail(key, "no material " + shown(name) + suggestion(name, names));
  }

  void read_laws() {
    if (!top_.has(keys::kLaw)) {
      throw SceneError(file_.name + ": law: missing; expected a table [law]");
    }
    TomlTable s = top_.table(keys::kLaw);
    scene_.law = read_law(s, Dim, scene_.normal, scene_.friction, nullptr);
    s.finish();
    top_.for_each(keys::kPair, [&](TomlTable& pair, int) { read_pair(pair); });
    if (scene_.integrator == IntegratorModel::fourth_order) {
      const std::string why = "\"fourth order\" is for forces without loss: it needs ";
      if (scene_.friction != FrictionModel::none) {
        top_.fail(keys::kIntegrator, why + "friction = \"none\"");
      }
      bool lossless = scene_.law.restitution == 1;
      for (const PairLaw& p : scene_.pairs)
        lossless = lossless && (p.law.restitution == 1 || !p.touch);
      if (!lossless) top_.fail(keys::kIntegrator, why + "restitution = 1");
    }
  }

  void read_pair(TomlTable& s) {
    const std::string what = "two materials";
    const auto names = s.texts(keys::kBetween, what, "a material");
    if (names.size() != 2) s.expected(keys::kBetween, what);
    PairLaw law;
    law.a = material_named(names[0], s, keys::kBetween);
    law.b = material_named(names[1], s, keys::kBetween);
    if (law.a > law.b) std::swap(law.a, law.b);
    for (const PairLaw& earlier : scene_.pairs) {
      if (earlier.a == law.a && earlier.b == law.b) {
        s.fail(keys::kBetween, "a second time [" + shown(names[0]) + ", " + shown(names[1]) + "]");
      }
    }
    law.touch = s.flag(keys::kTouch, law.touch);
    if (!law.touch) {
      for (const auto& law_keys :
           {description_of(scene_.normal).keys, description_of(scene_.friction).keys}) {
        for (const LawKey& key : law_keys) {
          s.refuse(detail::key_of(key), "the two do not touch; remove this line");
        }
      }
    }
    law.law = read_law(s, Dim, scene_.normal, scene_.friction, &scene_.law);
    scene_.pairs.push_back(law);
  }

  void read_fill(TomlTable& s) {
    Fill<Dim> fill;
    fill.name = s.text(keys::kName, "fill " + std::to_string(scene_.fills.size() + 1));
    fill.material = material_of(s, true);
    fill.arrangement =
        s.word<Arrangement>(keys::kArrangement, detail::kArrangementWords, fill.arrangement);
    if (fill.arrangement == Arrangement::random && !s.has(keys::kCount)) {
      s.missing(keys::kCount, "a number of grains");
    }
    fill.count = read_count(s);
    fill.radius = read_radius(s);
    fill.region = read_region(s);
    read_held(s, fill);
    if (fill.pinned) {
      s.refuse(keys::kVelocity, "pinned grains stay; remove this line");
      s.refuse(keys::kSpin, "pinned grains stay; remove this line");
    } else {
      read_velocity(s, fill);
    }
    read_spin(s, fill.spin);
    scene_.fills.push_back(std::move(fill));
  }

  static std::optional<int> read_count(TomlTable& s) {
    if (!s.has(keys::kCount)) return {};
    const std::int64_t count = s.integer(keys::kCount, 1, 1);
    if (count > kMostGrains) {
      s.expected(keys::kCount, "at most " + std::to_string(kMostGrains) + " grains");
    }
    return static_cast<int>(count);
  }

  static Region<Dim> read_region(TomlTable& s) {
    TomlTable inner = s.table(keys::kRegion, "{ low = [...], high = [...] }");
    Region<Dim> region{inner.template vector<Dim>(keys::kLow),
                       inner.template vector<Dim>(keys::kHigh)};
    inner.finish();
    if (!(region.low.array() < region.high.array()).all()) {
      s.fail(keys::kRegion, "expected low below high in every direction");
    }
    return region;
  }

  static Region<Dim> read_corners(TomlTable& s) {
    Region<Dim> region{s.vector<Dim>(keys::kLow), s.vector<Dim>(keys::kHigh)};
    if (!(region.low.array() < region.high.array()).all()) {
      s.fail(keys::kHigh, "expected low below high in every direction");
    }
    return region;
  }

  /// Of grains that may be held: pinned or driven.
  template <class Source>
  void read_held(TomlTable& s, Source& source) {
    source.pinned = s.flag(keys::kPinned, source.pinned);
    source.driven = s.flag(keys::kDriven, source.driven);
    if (source.pinned && source.driven) {
      s.fail(keys::kDriven, "what is driven moves, and what is pinned stays; choose one");
    }
    if (source.driven) expect_no_fourth_order("grains are driven");
  }

  void read_spin(TomlTable& s, SpinVec<Dim>& spin) {
    if (scene_.friction == FrictionModel::none) {
      s.refuse(keys::kSpin, "nothing spins in a scene with friction = \"none\"; remove this line");
    } else if (s.has(keys::kSpin)) {
      if constexpr (Dim == 2) {
        spin[0] = s.number(keys::kSpin);
      } else {
        spin = s.vector<Dim>(keys::kSpin);
      }
    }
  }

  /// Of a fill or an inlet.
  template <class Source>
  static void read_velocity(TomlTable& s, Source& source) {
    if (s.holds_table(keys::kVelocity)) {
      TomlTable inner = s.table(keys::kVelocity);
      source.random_speed = inner.number(keys::kRandomSpeed);
      inner.finish();
    } else if (s.has(keys::kVelocity)) {
      source.velocity = s.vector<Dim>(keys::kVelocity);
    }
  }

  void read_inlet(TomlTable& s) {
    Inlet<Dim> inlet;
    inlet.name = s.text(keys::kName, "inlet " + std::to_string(scene_.inlets.size() + 1));
    expect_new_door(s, inlet.name);
    inlet.material = material_of(s, true);
    inlet.radius = read_radius(s);
    inlet.region = read_region(s);
    const double width = (inlet.region.high - inlet.region.low).minCoeff();
    if (width * (1 + 1e-12) < 2 * detail::largest(inlet.radius)) {
      s.fail(keys::kRegion, "is " + rounded(width) + " m wide, too narrow for grains " +
                                rounded(2 * detail::largest(inlet.radius)) + " m wide");
    }
    inlet.rate = s.number(keys::kRate);
    read_times(s, inlet);
    inlet.count = read_count(s);
    read_velocity(s, inlet);
    expect_no_fourth_order("grains come in");
    scene_.inlets.push_back(std::move(inlet));
  }

  void read_outlet(TomlTable& s) {
    Outlet<Dim> outlet;
    outlet.name = s.text(keys::kName, "outlet " + std::to_string(scene_.outlets.size() + 1));
    expect_new_door(s, outlet.name);
    outlet.region = read_corners(s);
    for (const Inlet<Dim>& inlet : scene_.inlets) {
      if ((outlet.region.low.array() <= inlet.region.high.array()).all() &&
          (outlet.region.high.array() >= inlet.region.low.array()).all()) {
        s.fail(keys::kLow, "reaches into inlet \"" + inlet.name + "\": its grains would leave");
      }
    }
    expect_no_fourth_order("grains leave");
    scene_.outlets.push_back(std::move(outlet));
  }

  void read_domain() {
    if (!top_.has(keys::kDomain)) return;
    TomlTable s = top_.table(keys::kDomain);
    const Region<Dim> domain = read_corners(s);
    s.finish();
    const auto holds = [&](const Vec<Dim>& x) {
      return (x.array() >= domain.low.array()).all() && (x.array() <= domain.high.array()).all();
    };
    for (const Inlet<Dim>& inlet : scene_.inlets) {
      if (holds(inlet.region.low) && holds(inlet.region.high)) continue;
      top_.fail(keys::kDomain, "does not hold inlet \"" + inlet.name + "\"");
    }
    for (const Outlet<Dim>& outlet : scene_.outlets) {
      if (holds(outlet.region.low.cwiseMax(domain.low).cwiseMin(outlet.region.high))) continue;
      top_.fail(keys::kDomain,
                "ends before outlet \"" + outlet.name + "\", which no grain reaches");
    }
    expect_no_fourth_order("grains leave");
    scene_.domain = domain;
  }

  /// Inlets, outlets and planes are columns of the series.
  void expect_new_door(TomlTable& s, const std::string& name) {
    const auto called = [&](const auto& door) { return door.name == name; };
    if (std::any_of(scene_.inlets.begin(), scene_.inlets.end(), called) ||
        std::any_of(scene_.outlets.begin(), scene_.outlets.end(), called)) {
      s.fail(keys::kName, "a second \"" + name + "\"");
    }
  }

  void expect_no_fourth_order(const std::string& what) {
    if (scene_.integrator != IntegratorModel::fourth_order) return;
    top_.fail(keys::kIntegrator,
              "\"fourth order\" is for grains that stay and keep their energy, but here " + what +
                  "; choose another one");
  }

  void read_grain(TomlTable& s) {
    PlacedGrain<Dim> grain;
    grain.position = s.vector<Dim>(keys::kPosition);
    grain.radius = s.number(keys::kRadius);
    grain.material = material_of(s, true);
    read_held(s, grain);
    if (grain.pinned) {
      s.refuse(keys::kVelocity, "a pinned grain stays; remove this line");
      s.refuse(keys::kSpin, "a pinned grain stays; remove this line");
    }
    if (s.has(keys::kVelocity)) grain.velocity = s.vector<Dim>(keys::kVelocity);
    read_spin(s, grain.spin);
    scene_.grains.push_back(grain);
  }

  void read_start() {
    if (!top_.has(keys::kStart)) return;
    TomlTable s = top_.table(keys::kStart, "a run, such as { run = \"runs/bed\" }");
    if (!s.has(keys::kRun)) s.missing(keys::kRun, "the folder of a run");
    scene_.start = StartState{folder_ / s.text(keys::kRun)};
    // A run keeps no other state whole.
    if (s.has(keys::kInstant)) s.word(keys::kInstant, {detail::kLastState});
    s.finish();
  }

  void read_grain_file(TomlTable& s) {
    GrainFile<Dim> grains;
    if (!s.has(keys::kFile)) {
      s.missing(keys::kFile, "a file of grains (CSV); a single grain is a table [[grain]]");
    }
    grains.file = folder_ / s.text(keys::kFile);
    if (s.has(keys::kMaterial)) grains.material = material_of(s, true);
    if (s.has(keys::kShift)) grains.shift = s.vector<Dim>(keys::kShift);
    grains.at_rest = s.flag(keys::kAtRest, grains.at_rest);
    read_held(s, grains);
    scene_.grain_files.push_back(std::move(grains));
  }

  /// Reads a wall. Its keys tell its shape.
  void read_wall(TomlTable& s, int index) {
    const std::string name = s.text(keys::kName, "wall " + std::to_string(index + 1));
    const int material = material_of(s, false);
    Wall<Dim> wall = read_shape(s, name);
    wall.front_only = s.word<bool>(keys::kSolid, detail::kSolidWords, wall.front_only);
    if (const std::string defect = wall.defect(); !defect.empty()) s.fail(keys::kSolid, defect);
    if (s.has(keys::kTurning)) read_turning(s.table(keys::kTurning), wall);
    add_wall(s, std::move(wall), material);
  }

  Wall<Dim> read_shape(TomlTable& s, const std::string& name) {
    if (s.has(keys::kRadii) || s.has(keys::kHeight)) return read_frustum(s, name);
    if (s.has(keys::kRadius)) return read_cylinder(s, name);
    if (s.has(keys::kCorners)) return read_plates(s, name, keys::kCorners);
    if (s.has(keys::kPlates)) return read_plates(s, name, keys::kPlates);
    if (s.has(keys::kMesh)) return read_mesh(s, name);
    if (s.has(keys::kPoints)) return read_lines(s, name, keys::kPoints);
    if (s.has(keys::kLines)) return read_lines(s, name, keys::kLines);
    if (s.has(keys::kThrough)) return read_arc(s, name);
    if (s.has(keys::kPoint) || s.has(keys::kNormal)) return read_half_space(s, name);
    if (s.has(keys::kFrom) || s.has(keys::kTo) || s.has(keys::kAlong)) return read_segment(s, name);
    s.finish();
    s.missing(keys::kPoint,
              Dim == 2 ? "a shape: point and normal, from and to, points, or point and radius"
                       : "a shape: point and normal, corners, plates, mesh, point and radius, or "
                         "point, axis and radii");
  }

  /// Refuses the keys of other shapes.
  /// @param own  keys of this one
  void refuse_others(TomlTable& s, std::initializer_list<Key> own, const std::string& why) {
    for (const Key& key :
         {keys::kPoint, keys::kNormal, keys::kFrom, keys::kTo, keys::kAlong, keys::kThrough,
          keys::kPoints, keys::kLines, keys::kClosed, keys::kCorners, keys::kPlates, keys::kMesh,
          keys::kScale, keys::kRadius, keys::kRadii, keys::kHeight, keys::kAxis}) {
      const bool used =
          std::any_of(own.begin(), own.end(), [&](const Key& k) { return k.name == key.name; });
      if (!used) s.refuse(key, why + "; remove this line");
    }
  }

  Wall<Dim> read_half_space(TomlTable& s, const std::string& name) {
    const Vec<Dim> point = s.vector<Dim>(keys::kPoint);
    const Vec<Dim> normal = s.vector<Dim>(keys::kNormal);
    if (!is_direction(normal)) s.expected(keys::kNormal, "a direction");
    for (const Key& key : {keys::kFrom, keys::kTo, keys::kAlong}) {
      s.refuse(key, "either point and normal, or from and to");
    }
    s.refuse(keys::kAxis, "an axis belongs to a round wall, with point and radius");
    refuse_others(s, {keys::kPoint, keys::kNormal}, "a half-space has point and normal");
    Wall<Dim> wall = Wall<Dim>::half_space(name, point, normal);
    if (is_unit(normal)) wall.shape = HalfSpace<Dim>{normal};
    return wall;
  }

  Wall<Dim> read_segment(TomlTable& s, const std::string& name) {
    if constexpr (Dim == 3) {
      s.fail(s.has(keys::kFrom) ? keys::kFrom
             : s.has(keys::kTo) ? keys::kTo
                                : keys::kAlong,
             "in space a line has no thickness to touch; give the corners of a plate: corners = "
             "[[x, y, z], [x, y, z], [x, y, z], ...]");
    } else {
      const bool given_along = s.has(keys::kAlong);
      if (given_along) s.refuse(keys::kTo, "either to or along");
      refuse_others(s, {keys::kFrom, keys::kTo, keys::kAlong}, "a segment has from and to");
      const Vec<2> from = s.vector<2>(keys::kFrom);
      const Vec<2> along =
          given_along ? s.vector<2>(keys::kAlong) : Vec<2>(s.vector<2>(keys::kTo) - from);
      if (!(along.squaredNorm() > 0)) {
        s.fail(given_along ? keys::kAlong : keys::kTo, "expected another point than from");
      }
      return Wall<2>::sheet(name, from, {WallSegment(Vec<2>::Zero(), along)});
    }
  }

  /// The point that the places of a wall of pieces are counted from.
  Vec<Dim> read_origin(TomlTable& s) {
    return s.has(keys::kPoint) ? s.vector<Dim>(keys::kPoint) : Vec<Dim>(Vec<Dim>::Zero());
  }

  Wall<Dim> read_arc(TomlTable& s, const std::string& name) {
    if constexpr (Dim == 3) {
      s.fail(keys::kThrough, "an arc is for dimension = 2; in space give radii or plates");
    } else {
      refuse_others(s, {keys::kPoint, keys::kFrom, keys::kThrough, keys::kTo},
                    "an arc has from, through and to");
      const Vec<2> from = s.vector<2>(keys::kFrom), through = s.vector<2>(keys::kThrough),
                   to = s.vector<2>(keys::kTo);
      const std::string defect = Arc::defect(from, through, to);
      if (!defect.empty()) s.fail(keys::kThrough, defect);
      return Wall<2>::sheet(name, read_origin(s), {Arc(from, through, to)});
    }
  }

  /// Reads one polyline, or several.
  Wall<Dim> read_lines(TomlTable& s, const std::string& name, const Key& key) {
    if constexpr (Dim == 3) {
      s.fail(key, "lines are for dimension = 2; in space give plates");
    } else {
      refuse_others(s, {keys::kPoint, keys::kClosed, key},
                    "a wall of lines has " + std::string(key.name));
      const bool one = key.name == keys::kPoints.name;
      using Lines = std::vector<std::vector<Vec<2>>>;
      auto lines = one ? Lines{s.vectors<2>(key)} : s.vector_lists<2>(key);
      const bool closed = s.flag(keys::kClosed, false);
      std::vector<WallPiece<2>> pieces;
      for (auto& line : lines) {
        if (closed) line.push_back(line.front());
        if (line.size() < 2) s.fail(key, "a line needs at least two points");
        for (std::size_t k = 0; k + 1 < line.size(); ++k) {
          if (!((line[k + 1] - line[k]).squaredNorm() > 0)) {
            s.fail(key, "point " + std::to_string(k + 1) + " and the next are one");
          }
          pieces.push_back(WallSegment(line[k], line[k + 1]));
        }
      }
      return Wall<2>::sheet(name, read_origin(s), std::move(pieces));
    }
  }

  /// Reads one plate, or several.
  Wall<Dim> read_plates(TomlTable& s, const std::string& name, const Key& key) {
    if constexpr (Dim == 2) {
      s.fail(key, "a plate is for dimension = 3; in the plane give from and to");
    } else {
      refuse_others(s, {keys::kPoint, key}, "a plate has corners alone");
      const bool one = key.name == keys::kCorners.name;
      using Plates = std::vector<std::vector<Vec<3>>>;
      const auto plates = one ? Plates{s.vectors<3>(key)} : s.vector_lists<3>(key);
      std::vector<WallPiece<3>> pieces;
      for (const auto& corners : plates) {
        const std::string defect = Plate::defect(corners);
        const std::string which = one ? "" : "plate " + std::to_string(pieces.size() + 1) + ": ";
        if (!defect.empty()) s.fail(key, which + defect);
        pieces.push_back(Plate(corners));
      }
      // A single plate is counted from its first corner, unless it says otherwise.
      if (one && !s.has(keys::kPoint)) return Wall<3>::plate(name, plates.front());
      return Wall<3>::sheet(name, read_origin(s), std::move(pieces));
    }
  }

  Wall<Dim> read_mesh(TomlTable& s, const std::string& name) {
    if constexpr (Dim == 2) {
      s.fail(keys::kMesh, "a mesh is for dimension = 3; in the plane give points");
    } else {
      refuse_others(s, {keys::kPoint, keys::kMesh, keys::kScale}, "a mesh comes from its file");
      const std::filesystem::path file = folder_ / s.text(keys::kMesh);
      const double scale = s.number(keys::kScale, 1);
      try {
        return Wall<3>::sheet(name, read_origin(s), detail::read_stl(file, scale));
      } catch (const std::invalid_argument& defect) {
        s.fail(keys::kMesh, shortened(file.string(), 200) + ": " + defect.what());
      }
    }
  }

  Wall<Dim> read_frustum(TomlTable& s, const std::string& name) {
    const Key& key = s.has(keys::kRadii) ? keys::kRadii : keys::kHeight;
    if constexpr (Dim == 2) {
      s.fail(key,
             "it belongs to a round wall in space; in the plane give points, or an arc by "
             "from, through and to");
    } else {
      refuse_others(s, {keys::kPoint, keys::kAxis, keys::kHeight, keys::kRadius, keys::kRadii},
                    "a cone has point, axis, height and radii");
      Frustum frustum{Vec<3>::Zero(), s.vector<3>(keys::kAxis)};
      if (!is_direction(frustum.axis)) s.expected(keys::kAxis, "a direction");
      if (!is_unit(frustum.axis)) frustum.axis.normalize();
      frustum.height = s.number(keys::kHeight, 0);
      if (s.has(keys::kRadii)) {
        s.refuse(keys::kRadius, "either radius or radii");
        const auto radii = s.numbers(keys::kRadii);
        if (radii.size() != 2) s.expected(keys::kRadii, "[radius at point, radius at the end]");
        frustum.low_radius = radii[0];
        frustum.high_radius = radii[1];
      } else {
        frustum.low_radius = frustum.high_radius = s.number(keys::kRadius);
      }
      const std::string defect = frustum.defect();
      if (!defect.empty()) s.fail(key, defect);
      return Wall<3>::sheet(name, s.vector<3>(keys::kPoint), {frustum});
    }
  }

  Wall<Dim> read_cylinder(TomlTable& s, const std::string& name) {
    const double radius = s.number(keys::kRadius);
    const Vec<Dim> point = s.vector<Dim>(keys::kPoint);
    const std::string why =
        "a round wall has point" + std::string(Dim == 3 ? ", axis" : "") + " and radius";
    Vec<Dim> axis = Vec<Dim>::Zero();
    if (Dim == 2) {
      s.refuse(keys::kAxis, "a circle has none; remove this line");
    } else {
      axis = s.vector<Dim>(keys::kAxis);
      if (!is_direction(axis)) s.expected(keys::kAxis, "a direction");
    }
    refuse_others(s, {keys::kPoint, keys::kAxis, keys::kRadius}, why);
    Wall<Dim> wall = Wall<Dim>::cylinder(name, point, axis, radius);
    if (is_unit(axis)) wall.shape = Cylinder<Dim>{radius, axis};
    return wall;
  }

  /// Reads the sides of a box as walls of their own, called by the direction in which they lie.
  void read_box(TomlTable& s) {
    const Vec<Dim> low = s.vector<Dim>(keys::kLow);
    const Vec<Dim> high = s.vector<Dim>(keys::kHigh);
    if (!(low.array() < high.array()).all()) {
      s.fail(keys::kHigh, "expected low below high in every direction");
    }
    const std::string prefix = s.text(keys::kName, "");
    const int material = material_of(s, false);
    std::vector<std::string> sides{"left", "right"};
    if (Dim == 3) sides.insert(sides.end(), {"front", "back"});
    sides.insert(sides.end(), {"bottom", "top"});
    const std::vector<std::string> open = open_sides(s, sides);
    const auto openings = read_openings(s, sides, open, low, high);
    for (std::size_t k = 0; k < sides.size(); ++k) {
      if (std::find(open.begin(), open.end(), sides[k]) != open.end()) continue;
      const auto across = static_cast<Eigen::Index>(k / 2);
      Vec<Dim> inwards = Vec<Dim>::Zero();
      inwards[across] = k % 2 == 0 ? 1 : -1;
      const std::string name = prefix.empty() ? sides[k] : prefix + " " + sides[k];
      const auto opening = openings.find(sides[k]);
      Box face(low, high);
      (k % 2 == 0 ? face.max() : face.min())[across] = (k % 2 == 0 ? low : high)[across];
      Wall<Dim> wall = Wall<Dim>::half_space(name, k % 2 == 0 ? low : high, inwards);
      if (opening != openings.end()) {
        auto pieces = pieces_around(face, opening->second, across);
        if (pieces.empty()) {
          s.fail(keys::kOpenings, "nothing is left of side \"" + sides[k] +
                                      "\"; leave it out: open = [\"" + sides[k] + "\"]");
        }
        wall = Wall<Dim>::sheet(name, Vec<Dim>::Zero(), std::move(pieces));
      }
      add_wall(s, std::move(wall), material);
      if (std::holds_alternative<Piston<Dim>>(scene_.walls.back().motion)) {
        s.fail(keys::kMotion,
               "each side would move for itself; leave the side open and give the piston as a "
               "[[wall]]");
      }
    }
  }

  using Box = Eigen::AlignedBox<double, Dim>;

  /// The openings of a box: side -> box that reaches through it.
  std::map<std::string, Box> read_openings(TomlTable& s, const std::vector<std::string>& sides,
                                           const std::vector<std::string>& open,
                                           const Vec<Dim>& low, const Vec<Dim>& high) {
    std::map<std::string, Box> openings;
    s.for_each(keys::kOpenings, [&](TomlTable& o, int) {
      const auto k = static_cast<std::size_t>(std::distance(
          sides.begin(), std::find(sides.begin(), sides.end(),
                                   side_named(o, o.text(keys::kSide), keys::kSide, sides))));
      const std::string& side = sides[k];
      if (std::find(open.begin(), open.end(), side) != open.end()) {
        o.fail(keys::kSide, "side \"" + side + "\" is left out as a whole; remove this opening");
      }
      if (openings.contains(side)) {
        o.fail(keys::kSide, "a second opening in \"" + side + "\"; give its pieces as [[wall]]");
      }
      const auto from = o.template vector<Dim - 1>(keys::kLow);
      const auto to = o.template vector<Dim - 1>(keys::kHigh);
      Box opening(low, high);
      for (int d = 0, e = 0; d < Dim; ++d) {
        if (d == static_cast<int>(k / 2)) continue;
        opening.min()[d] = from[e];
        opening.max()[d] = to[e++];
      }
      if (!(opening.min().array() < opening.max().array()).all() ||
          !Box(low, high).contains(opening)) {
        o.fail(keys::kLow, "expected low below high, both on the side");
      }
      openings.emplace(side, opening);
    });
    return openings;
  }

  /// What is left of a side of a box, flat across one direction, around an opening. A strip that
  /// is as thin as a joint is left out.
  static std::vector<WallPiece<Dim>> pieces_around(const Box& face, const Box& opening,
                                                   Eigen::Index across) {
    std::vector<WallPiece<Dim>> pieces;
    const auto add = [&](const Box& part) {
      if constexpr (Dim == 2) {
        if (part.diagonal().norm() <= kSeam * face.diagonal().norm()) return;
        pieces.push_back(WallSegment(part.min(), part.max()));
      } else {
        const Eigen::Index u = (across + 1) % 3, v = (across + 2) % 3;
        std::vector<Vec<3>> corners(4, part.min());
        corners[1][u] = corners[2][u] = part.max()[u];
        corners[2][v] = corners[3][v] = part.max()[v];
        if (Plate::defect(corners).empty()) pieces.push_back(Plate(corners));
      }
    };
    // Direction by direction, a part before the opening, one behind it, and the rest beside it.
    Box rest = face;
    for (Eigen::Index d = 0; d < Dim; ++d) {
      if (d == across) continue;
      Box before = rest, behind = rest;
      before.max()[d] = opening.min()[d];
      behind.min()[d] = opening.max()[d];
      add(before);
      add(behind);
      rest.min()[d] = opening.min()[d];
      rest.max()[d] = opening.max()[d];
    }
    return pieces;
  }

  std::string side_named(TomlTable& s, const std::string& side, const Key& key,
                         const std::vector<std::string>& sides) {
    if (std::find(sides.begin(), sides.end(), side) != sides.end()) return side;
    s.fail(key, "no side " + shown(side) + suggestion(side, sides) +
                    "; expected some of left, right, " + (Dim == 3 ? "front, back, " : "") +
                    "bottom, top");
  }

  std::vector<std::string> open_sides(TomlTable& s, const std::vector<std::string>& sides) {
    if (!s.has(keys::kOpen)) return {};
    auto open = s.texts(keys::kOpen, "a list of sides", "a side");
    for (const std::string& side : open) side_named(s, side, keys::kOpen, sides);
    return open;
  }

  void add_wall(TomlTable& s, Wall<Dim> wall, int material) {
    for (const Wall<Dim>& other : scene_.walls) {
      if (other.name == wall.name) s.fail(keys::kName, "a second \"" + wall.name + "\"");
    }
    wall.material = material;
    if (s.has(keys::kMotion)) read_motion(s.table(keys::kMotion), wall);
    if (s.has(keys::kBelt)) wall.belt = s.vector<Dim>(keys::kBelt);
    wall.until = s.number(keys::kUntil, wall.until);
    if (scene_.integrator == IntegratorModel::fourth_order && wall.drives()) {
      s.fail(wall.turns()  ? keys::kTurning
             : wall.runs() ? keys::kBelt
                           : keys::kMotion,
             "integrator = \"fourth order\" needs walls at rest; remove this motion");
    }
    if (const std::string defect = wall.defect(); !defect.empty()) {
      s.fail(wall.turns() ? keys::kTurning : keys::kMotion, defect);
    }
    scene_.walls.push_back(std::move(wall));
  }

  /// Whether there is a unit vector along it: not where its square is 0 or more than doubles hold.
  static bool is_direction(const Vec<Dim>& v) { return std::isnormal(v.squaredNorm()); }

  /// Normalising a unit vector again may change its last bit; a resolved scene must not.
  static bool is_unit(const Vec<Dim>& v) { return std::abs(v.squaredNorm() - 1) < 1e-14; }

  void read_motion(TomlTable s, Wall<Dim>& wall) {
    const auto type = s.word<detail::MotionType>(keys::kType, detail::kMotionWords);
    switch (type) {
      case detail::MotionType::steady: {
        Steady<Dim> m;
        m.velocity = s.vector<Dim>(keys::kVelocity);
        read_times(s, m);
        wall.motion = m;
        break;
      }
      case detail::MotionType::shake: {
        Shake<Dim> m;
        m.amplitude = s.vector<Dim>(keys::kAmplitude);
        m.frequency = s.number(keys::kFrequency);
        read_times(s, m);
        wall.motion = m;
        break;
      }
      case detail::MotionType::path: {
        const Path<Dim> m{s.numbers(keys::kTimes), s.vectors<Dim>(keys::kShifts)};
        wall.motion = m;
        break;
      }
      case detail::MotionType::piston: {
        Piston<Dim> m{};
        m.mass = s.number(keys::kPistonMass);
        if (s.has(keys::kPressure)) {
          s.refuse(keys::kLoad, "either load or pressure");
          read_pressure(s, m, wall);
        } else {
          s.refuse(keys::kBetween, "it bounds the face that a pressure acts on; give pressure");
          m.load = s.vector<Dim>(keys::kLoad);
          if (!is_direction(m.load)) s.expected(keys::kLoad, "a force: the piston moves along it");
        }
        m.start = s.number(keys::kStart, m.start);
        s.refuse(keys::kStop, "a piston has none: grains stop it; remove this line");
        wall.motion = m;
        break;
      }
    }
    s.finish();
  }

  /// The walls that it presses between are found when all have been read.
  void read_pressure(TomlTable& s, Piston<Dim>& piston, const Wall<Dim>& wall) {
    const auto* face = std::get_if<HalfSpace<Dim>>(&wall.shape);
    if (!face) s.fail(keys::kPressure, "it acts along a normal; give the piston point and normal");
    piston.load = Vec<Dim>::Zero();
    piston.pressure.emplace();
    piston.pressure->value = s.number(keys::kPressure);
    if (Dim == 2) piston.pressure->depth = scene_.depth;
    const std::string what = Dim == 2 ? "the names of the two walls that it presses between"
                                      : "the names of four walls: it presses between the first "
                                        "two, and between the others";
    const auto names = s.texts(keys::kBetween, what, "a wall");
    if (names.size() != 2 * (Dim - 1)) s.expected(keys::kBetween, what);
    pressures_.push_back({scene_.walls.size(), names, s});
  }

  void resolve_pressures() {
    std::vector<std::string> known;
    for (const Wall<Dim>& wall : scene_.walls) known.push_back(wall.name);
    for (auto& [number, names, s] : pressures_) {
      Wall<Dim>& wall = scene_.walls[number];
      auto& between = std::get<Piston<Dim>>(wall.motion).pressure->between;
      for (std::size_t k = 0; k < names.size(); ++k) {
        const auto found = std::find(known.begin(), known.end(), names[k]);
        if (found == known.end()) {
          s.fail(keys::kBetween, "no wall " + shown(names[k]) + suggestion(names[k], known));
        }
        between[k / 2][k % 2] = static_cast<int>(found - known.begin());
      }
      const std::string defect = pressure_defect(scene_.walls, wall);
      if (!defect.empty()) s.fail(keys::kBetween, defect);
    }
  }

  void read_turning(TomlTable s, Wall<Dim>& wall) {
    const auto type = s.word<detail::TurningType>(keys::kType, detail::kTurningWords);
    const SpinVec<Dim> axis = read_axis(s);
    const Vec<Dim> about = s.has(keys::kAbout) ? s.vector<Dim>(keys::kAbout) : wall.home;
    if (type == detail::TurningType::steady) {
      Turn<Dim> turn{axis, s.number(keys::kTurningRate), about};
      read_times(s, turn);
      wall.turning = turn;
    } else {
      Swing<Dim> swing{axis, s.number(keys::kAngle), s.number(keys::kFrequency), about};
      read_times(s, swing);
      wall.turning = swing;
    }
    s.finish();
  }

  /// What something turns about.
  static SpinVec<Dim> read_axis(TomlTable& s) {
    SpinVec<Dim> axis = SpinVec<Dim>::Ones();
    if constexpr (Dim == 2) {
      s.refuse(keys::kAxis, "in the plane all turns about the same; remove this line");
    } else {
      axis = s.vector<3>(keys::kAxis);
      if (!is_direction(axis)) s.expected(keys::kAxis, "a direction");
      if (!is_unit(axis)) axis.normalize();
    }
    return axis;
  }

  template <class Motion>
  static void read_times(TomlTable& s, Motion& m) {
    m.start = s.number(keys::kStart, m.start);
    m.stop = s.number(keys::kStop, m.stop);
    if (!(m.start < m.stop)) s.fail(keys::kStop, "expected a time after start");
  }

  void read_measure(TomlTable& s, int index) {
    const std::string name = s.text(keys::kName, "measure " + std::to_string(index + 1));
    const auto called = [&](const auto& other) { return other.name == name; };
    if (std::any_of(scene_.measures.begin(), scene_.measures.end(), called) ||
        std::any_of(scene_.planes.begin(), scene_.planes.end(), called)) {
      s.fail(keys::kName, "a second \"" + name + "\"");
    }
    if (s.has(keys::kPoint) || s.has(keys::kNormal)) {
      read_plane(s, name);
      return;
    }
    if (!s.has(keys::kRegion)) s.missing(keys::kRegion, "a region, or point and normal of a plane");
    MeasuredRegion<Dim> measure{.name = name, .region = read_region(s)};
    const std::int64_t slices = s.integer(keys::kSlices, 1, measure.slices);
    if (slices > kMostSlices) {
      s.expected(keys::kSlices, "at most " + std::to_string(kMostSlices) + " slices");
    }
    measure.slices = static_cast<int>(slices);
    if (s.has(keys::kAxis)) {
      const std::vector<std::string_view> axes{"x", "y", "z"};
      measure.axis = static_cast<int>(s.word(keys::kAxis, {axes.begin(), axes.begin() + Dim}));
    }
    scene_.measures.push_back(std::move(measure));
  }

  /// Reads a plane through which the flow is measured.
  void read_plane(TomlTable& s, const std::string& name) {
    expect_new_door(s, name);
    MeasuredPlane<Dim> plane{name, s.vector<Dim>(keys::kPoint), s.vector<Dim>(keys::kNormal), {}};
    if (!is_direction(plane.normal)) s.expected(keys::kNormal, "a direction");
    if (!is_unit(plane.normal)) plane.normal.normalize();
    if (s.has(keys::kRegion)) plane.region = read_region(s);
    for (const Key& key : {keys::kSlices, keys::kAxis}) {
      s.refuse(key, "a plane has no slices; remove this line");
    }
    scene_.planes.push_back(std::move(plane));
  }

  void read_output() {
    if (!top_.has(keys::kOutput)) return;
    TomlTable s = top_.table(keys::kOutput);
    OutputPlan& plan = scene_.output;
    plan.frames_every = s.number(keys::kFramesEvery, plan.frames_every);
    plan.series_every = s.number(keys::kSeriesEvery, plan.series_every);
    plan.contacts = s.flag(keys::kContacts, plan.contacts);
    if (s.has(keys::kFormats)) plan.formats = read_formats(s);
    s.finish();
  }

  static std::vector<OutputFormat> read_formats(TomlTable& s) {
    const char* what = "a list of \"csv\", \"vtp\", \"xyz\", each at most once";
    std::vector<OutputFormat> formats;
    for (const std::string& text : s.texts(keys::kFormats, what, what)) {
      const auto word = std::find_if(detail::kFormatWords.begin(), detail::kFormatWords.end(),
                                     [&](const auto& w) { return w.text == text; });
      if (word == detail::kFormatWords.end() ||
          std::find(formats.begin(), formats.end(), word->value) != formats.end()) {
        s.expected(keys::kFormats, what);
      }
      formats.push_back(word->value);
    }
    return formats;
  }

  /// A piston that holds a pressure between walls that may come later.
  struct PressureBetween {
    std::size_t wall;
    std::vector<std::string> names;
    TomlTable motion;  // for messages
  };

  Scene<Dim> scene_;
  TomlFile file_;
  std::filesystem::path folder_;
  TomlTable top_;
  std::vector<PressureBetween> pressures_;
};

/// Scenes are called by their file's name in messages, without the folder.
std::string called(const std::filesystem::path& file) { return file.filename().string(); }

int dimension_of(const toml::table& root, const std::string& name) {
  const std::string key(keys::kDimension.name);
  const toml::node* node = root.get(key);
  if (node == nullptr) throw SceneError(name + ": " + key + ": missing; expected 2 or 3");
  const auto* value = node->as_integer();
  if (value == nullptr || (value->get() != 2 && value->get() != 3)) {
    TomlFile{name, nullptr}.expected(*node, key, "2 or 3");
  }
  return static_cast<int>(value->get());
}

/// A scene's table, with settings in place of what stands in it.
toml::table table_of(std::string_view text, const std::string& name, const Settings& settings) {
  toml::table root = detail::parse_toml(text, name);
  for (const std::string& setting : settings) detail::apply_setting(root, setting);
  return root;
}

template <int Dim>
Scene<Dim> parse(const toml::table& root, const std::string& name,
                 const std::filesystem::path& folder) {
  if (const int found = dimension_of(root, name); found != Dim) {
    const std::string key(keys::kDimension.name);
    TomlFile{name, nullptr}.fail(
        *root.get(key), key, "expected " + std::to_string(Dim) + ", got " + std::to_string(found));
  }
  return Reader<Dim>(root, name, folder).read();
}

}  // namespace

int scene_dimension(const std::filesystem::path& file, const Settings& settings) {
  return dimension_of(table_of(read_file(file), called(file), settings), called(file));
}

template <int Dim>
Scene<Dim> parse_scene(std::string_view text, const std::string& name, const Settings& settings) {
  return parse<Dim>(table_of(text, name, settings), name, {});
}

template <int Dim>
Scene<Dim> read_scene(const std::filesystem::path& file, const Settings& settings) {
  return parse<Dim>(table_of(read_file(file), called(file), settings), called(file),
                    file.parent_path());
}

template Scene<2> read_scene<2>(const std::filesystem::path&, const Settings&);
template Scene<3> read_scene<3>(const std::filesystem::path&, const Settings&);
template Scene<2> parse_scene<2>(std::string_view, const std::string&, const Settings&);
template Scene<3> parse_scene<3>(std::string_view, const std::string&, const Settings&);

}  // namespace lagrain
