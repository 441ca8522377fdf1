// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/scene.hpp>

#include "scene_keys.hpp"
#include "toml_table.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <numeric>
#include <sstream>
#include <stdexcept>

namespace lagrain {
namespace {

using detail::Key;
using detail::suggestion;
using detail::TomlFile;
using detail::TomlTable;
namespace keys = detail::keys;

constexpr int kMostGrains = 100'000'000;
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
void read_numbers(TomlTable& s, std::span<const LawKey> law_keys, const LawNumbers* base,
                  LawNumbers& numbers) {
  for (const LawKey& law_key : law_keys) {
    const Key key = detail::key_of(law_key);
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

LawNumbers read_law(TomlTable& s, NormalModel normal, FrictionModel friction,
                    const LawNumbers* base) {
  LawNumbers numbers = base != nullptr ? *base : LawNumbers{};
  read_numbers(s, description_of(normal).keys, base, numbers);
  read_numbers(s, description_of(friction).keys, base, numbers);
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

RadiusLaw read_radius(TomlTable& s) {
  if (!s.holds_table(keys::kRadius)) return s.number(keys::kRadius);
  TomlTable inner = s.table(keys::kRadius);
  if (!inner.has(keys::kUniform) && !inner.has(keys::kValues)) {
    inner.finish();
    s.fail(keys::kRadius, "expected uniform = [low, high] or values = [...]");
  }
  RadiusLaw law;
  if (inner.has(keys::kUniform)) {
    const auto bounds = inner.numbers(keys::kUniform);
    if (bounds.size() != 2 || bounds[0] > bounds[1]) {
      inner.expected(keys::kUniform, "[smallest, largest]");
    }
    inner.refuse(keys::kValues, "either uniform or values");
    inner.refuse(keys::kWeights, "weights belong to values");
    law = UniformRadius{bounds[0], bounds[1]};
  } else {
    ListedRadius listed;
    listed.values = inner.numbers(keys::kValues);
    listed.weights = inner.has(keys::kWeights) ? inner.numbers(keys::kWeights)
                                               : std::vector<double>(listed.values.size(), 1.0);
    if (listed.weights.size() != listed.values.size() ||
        std::accumulate(listed.weights.begin(), listed.weights.end(), 0.0) <= 0) {
      s.fail(keys::kRadius, "expected as many weights as values, not all 0");
    }
    law = std::move(listed);
  }
  inner.finish();
  return law;
}

template <int Dim>
class Reader {
 public:
  Reader(const toml::table& root, const std::string& name)
      : file_{name, &scene_.lines}, top_(file_, root, "") {}

  Scene<Dim> read() {
    scene_.file = file_.name;
    read_top();
    read_materials();
    read_laws();
    top_.for_each(keys::kFill, [&](TomlTable& s, int) { read_fill(s); });
    top_.for_each(keys::kGrain, [&](TomlTable& s, int) { read_grain(s); });
    top_.for_each(keys::kWall, [&](TomlTable& s, int index) { read_wall(s, index); });
    top_.for_each(keys::kBox, [&](TomlTable& s, int) { read_box(s); });
    read_output();
    top_.finish();
    if (scene_.fills.empty() && scene_.grains.empty()) {
      throw SceneError(file_.name + ": no grains: expected at least one [[fill]] or [[grain]]");
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
    scene_.gravity = top_.vector<Dim>(keys::kGravity);
    if (Dim == 2) {
      scene_.depth = top_.number(keys::kDepth, scene_.depth);
    } else {
      top_.refuse(keys::kDepth, "spheres have none; remove this line");
    }
    scene_.normal = law_word<NormalModel>(top_, keys::kNormalLaw, kNormalLaws);
    scene_.friction = law_word<FrictionModel>(top_, keys::kFrictionLaw, kFrictionLaws);
    scene_.integrator =
        top_.word<IntegratorModel>(keys::kIntegrator, detail::kIntegratorWords, scene_.integrator);
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
    s.fail(key, "no material \"" + name + "\"" + suggestion(name, names));
  }

  void read_laws() {
    if (!top_.has(keys::kLaw)) {
      throw SceneError(file_.name + ": law: missing; expected a table [law]");
    }
    TomlTable s = top_.table(keys::kLaw);
    scene_.law = read_law(s, scene_.normal, scene_.friction, nullptr);
    s.finish();
    top_.for_each(keys::kPair, [&](TomlTable& pair, int) { read_pair(pair); });
    if (scene_.integrator == IntegratorModel::fourth_order) {
      const std::string why = "\"fourth order\" is for forces without loss: it needs ";
      if (scene_.friction != FrictionModel::none) {
        top_.fail(keys::kIntegrator, why + "friction = \"none\"");
      }
      bool lossless = scene_.law.restitution == 1;
      for (const PairLaw& p : scene_.pairs) lossless = lossless && p.law.restitution == 1;
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
        s.fail(keys::kBetween, "a second time [\"" + names[0] + "\", \"" + names[1] + "\"]");
      }
    }
    law.law = read_law(s, scene_.normal, scene_.friction, &scene_.law);
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
    if (s.has(keys::kCount)) {
      const std::int64_t count = s.integer(keys::kCount, 1, 1);
      if (count > kMostGrains) {
        s.expected(keys::kCount, "at most " + std::to_string(kMostGrains) + " grains");
      }
      fill.count = static_cast<int>(count);
    }
    fill.radius = read_radius(s);
    TomlTable region = s.table(keys::kRegion, "{ low = [...], high = [...] }");
    fill.low = region.template vector<Dim>(keys::kLow);
    fill.high = region.template vector<Dim>(keys::kHigh);
    region.finish();
    if (!(fill.low.array() < fill.high.array()).all()) {
      s.fail(keys::kRegion, "expected low below high in every direction");
    }
    if (s.holds_table(keys::kVelocity)) {
      TomlTable inner = s.table(keys::kVelocity);
      fill.random_speed = inner.number(keys::kRandomSpeed);
      inner.finish();
    } else if (s.has(keys::kVelocity)) {
      fill.velocity = s.vector<Dim>(keys::kVelocity);
    }
    scene_.fills.push_back(std::move(fill));
  }

  void read_grain(TomlTable& s) {
    PlacedGrain<Dim> grain;
    grain.position = s.vector<Dim>(keys::kPosition);
    grain.radius = s.number(keys::kRadius);
    grain.material = material_of(s, true);
    grain.pinned = s.flag(keys::kPinned, grain.pinned);
    if (grain.pinned) {
      s.refuse(keys::kVelocity, "a pinned grain stays; remove this line");
      s.refuse(keys::kSpin, "a pinned grain stays; remove this line");
    }
    if (s.has(keys::kVelocity)) grain.velocity = s.vector<Dim>(keys::kVelocity);
    if (scene_.friction == FrictionModel::none) {
      s.refuse(keys::kSpin, "nothing spins in a scene with friction = \"none\"; remove this line");
    } else if (s.has(keys::kSpin)) {
      if constexpr (Dim == 2) {
        grain.spin[0] = s.number(keys::kSpin);
      } else {
        grain.spin = s.vector<Dim>(keys::kSpin);
      }
    }
    scene_.grains.push_back(grain);
  }

  void read_wall(TomlTable& s, int index) {
    const std::string name = s.text(keys::kName, "wall " + std::to_string(index + 1));
    const int material = material_of(s, false);
    Wall<Dim> wall;
    if (s.has(keys::kRadius)) {
      wall = read_cylinder(s, name);
    } else if (s.has(keys::kCorners)) {
      wall = read_plate(s, name);
    } else if (s.has(keys::kPoint) || s.has(keys::kNormal)) {
      wall = read_half_space(s, name);
    } else if (s.has(keys::kFrom) || s.has(keys::kTo) || s.has(keys::kAlong)) {
      wall = read_segment(s, name);
    } else {
      s.finish();
      s.missing(keys::kPoint, std::string("point and normal, ") +
                                  (Dim == 2 ? "from and to" : "corners") + ", or point and radius");
    }
    add_wall(s, std::move(wall), material);
  }

  Wall<Dim> read_half_space(TomlTable& s, const std::string& name) {
    const Vec<Dim> point = s.vector<Dim>(keys::kPoint);
    const Vec<Dim> normal = s.vector<Dim>(keys::kNormal);
    if (normal.isZero(0)) s.expected(keys::kNormal, "a direction");
    for (const Key& key : {keys::kFrom, keys::kTo, keys::kAlong}) {
      s.refuse(key, "either point and normal, or from and to");
    }
    s.refuse(keys::kAxis, "an axis belongs to a round wall, with point and radius");
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
      const Vec<2> from = s.vector<2>(keys::kFrom);
      const bool given_along = s.has(keys::kAlong);
      Wall<2> wall = Wall<2>::segment(name, from, from);
      if (given_along) {
        s.refuse(keys::kTo, "either to or along");
        wall.shape = WallSegment{s.vector<2>(keys::kAlong)};
      } else {
        wall = Wall<2>::segment(name, from, s.vector<2>(keys::kTo));
      }
      if (std::get<WallSegment>(wall.shape).along.isZero(0)) {
        s.fail(given_along ? keys::kAlong : keys::kTo, "expected another point than from");
      }
      return wall;
    }
  }

  Wall<Dim> read_plate(TomlTable& s, const std::string& name) {
    if constexpr (Dim == 2) {
      s.fail(keys::kCorners, "a plate is for dimension = 3; in the plane give from and to");
    } else {
      for (const Key& key : {keys::kNormal, keys::kFrom, keys::kTo, keys::kAlong, keys::kAxis}) {
        s.refuse(key, "a plate has corners alone; remove this line");
      }
      const auto corners = s.vectors<3>(keys::kCorners);
      const std::string defect = Plate::defect(corners);
      if (!defect.empty()) s.fail(keys::kCorners, defect);
      Wall<3> wall = Wall<3>::plate(name, corners);
      if (s.has(keys::kPoint)) {
        wall.point = wall.home = s.vector<3>(keys::kPoint);
        wall.shape = Plate(corners);
      }
      return wall;
    }
  }

  Wall<Dim> read_cylinder(TomlTable& s, const std::string& name) {
    const double radius = s.number(keys::kRadius);
    const Vec<Dim> point = s.vector<Dim>(keys::kPoint);
    for (const Key& key : {keys::kNormal, keys::kFrom, keys::kTo, keys::kAlong, keys::kCorners}) {
      s.refuse(key, "a round wall has point" + std::string(Dim == 3 ? ", axis" : "") +
                        " and radius; remove this line");
    }
    Vec<Dim> axis = Vec<Dim>::Zero();
    if (Dim == 2) {
      s.refuse(keys::kAxis, "a circle has none; remove this line");
    } else {
      axis = s.vector<Dim>(keys::kAxis);
      if (axis.isZero(0)) s.expected(keys::kAxis, "a direction");
    }
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
    for (std::size_t k = 0; k < sides.size(); ++k) {
      if (std::find(open.begin(), open.end(), sides[k]) != open.end()) continue;
      Vec<Dim> inwards = Vec<Dim>::Zero();
      inwards[static_cast<Eigen::Index>(k / 2)] = k % 2 == 0 ? 1 : -1;
      const std::string name = prefix.empty() ? sides[k] : prefix + " " + sides[k];
      add_wall(s, Wall<Dim>::half_space(name, k % 2 == 0 ? low : high, inwards), material);
      if (std::holds_alternative<Piston<Dim>>(scene_.walls.back().motion)) {
        s.fail(keys::kMotion,
               "each side would move for itself; leave the side open and give the piston as a "
               "[[wall]]");
      }
    }
  }

  std::vector<std::string> open_sides(TomlTable& s, const std::vector<std::string>& sides) {
    if (!s.has(keys::kOpen)) return {};
    auto open = s.texts(keys::kOpen, "a list of sides", "a side");
    for (const std::string& side : open) {
      if (std::find(sides.begin(), sides.end(), side) != sides.end()) continue;
      s.fail(keys::kOpen, "no side \"" + side + "\"" + suggestion(side, sides) +
                              "; expected some of left, right, " +
                              (Dim == 3 ? "front, back, " : "") + "bottom, top");
    }
    return open;
  }

  void add_wall(TomlTable& s, Wall<Dim> wall, int material) {
    for (const Wall<Dim>& other : scene_.walls) {
      if (other.name == wall.name) s.fail(keys::kName, "a second \"" + wall.name + "\"");
    }
    wall.material = material;
    if (s.has(keys::kMotion)) read_motion(s.table(keys::kMotion), wall);
    scene_.walls.push_back(std::move(wall));
  }

  /// Normalising a unit vector again may change its last bit; a resolved scene must not.
  static bool is_unit(const Vec<Dim>& v) { return std::abs(v.squaredNorm() - 1) < 1e-14; }

  void read_motion(TomlTable s, Wall<Dim>& wall) {
    const auto type = s.word<detail::MotionType>(keys::kType, detail::kMotionWords);
    if (scene_.integrator == IntegratorModel::fourth_order) {
      s.fail(keys::kType, "integrator = \"fourth order\" needs walls at rest; remove this motion");
    }
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
      case detail::MotionType::piston: {
        Piston<Dim> m{};
        m.mass = s.number(keys::kPistonMass);
        m.load = s.vector<Dim>(keys::kLoad);
        if (m.load.isZero(0)) s.expected(keys::kLoad, "a force: the piston moves along it");
        m.start = s.number(keys::kStart, m.start);
        s.refuse(keys::kStop, "a piston has none: grains stop it; remove this line");
        wall.motion = m;
        break;
      }
    }
    s.finish();
  }

  template <class Motion>
  static void read_times(TomlTable& s, Motion& m) {
    m.start = s.number(keys::kStart, m.start);
    m.stop = s.number(keys::kStop, m.stop);
    if (!(m.start < m.stop)) s.fail(keys::kStop, "expected a time after start");
  }

  void read_output() {
    if (!top_.has(keys::kOutput)) return;
    TomlTable s = top_.table(keys::kOutput);
    OutputPlan& plan = scene_.output;
    plan.frames_every = s.number(keys::kFramesEvery, plan.frames_every);
    plan.series_every = s.number(keys::kSeriesEvery, plan.series_every);
    plan.contacts = s.flag(keys::kContacts, plan.contacts);
    s.finish();
  }

  Scene<Dim> scene_;
  TomlFile file_;
  TomlTable top_;
};

std::string whole_file(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    throw SceneError(file.string() + ": expected a scene file, got a folder");
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) throw SceneError(file.string() + ": cannot be read");
  std::ostringstream text;
  text << in.rdbuf();
  return std::move(text).str();
}

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

}  // namespace

int scene_dimension(const std::filesystem::path& file) {
  return dimension_of(detail::parse_toml(whole_file(file), called(file)), called(file));
}

template <int Dim>
Scene<Dim> parse_scene(std::string_view text, const std::string& name) {
  const toml::table root = detail::parse_toml(text, name);
  if (const int found = dimension_of(root, name); found != Dim) {
    const std::string key(keys::kDimension.name);
    TomlFile{name, nullptr}.fail(
        *root.get(key), key, "expected " + std::to_string(Dim) + ", got " + std::to_string(found));
  }
  return Reader<Dim>(root, name).read();
}

template <int Dim>
Scene<Dim> read_scene(const std::filesystem::path& file) {
  return parse_scene<Dim>(whole_file(file), called(file));
}

template Scene<2> read_scene<2>(const std::filesystem::path&);
template Scene<3> read_scene<3>(const std::filesystem::path&);
template Scene<2> parse_scene<2>(std::string_view, const std::string&);
template Scene<3> parse_scene<3>(std::string_view, const std::string&);

}  // namespace lagrain
