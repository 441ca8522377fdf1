#include <lagrain/scene.hpp>

#include <lagrain/units.hpp>

// Header-only, in this file alone: an installed lagrain then needs no toml++.
#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>
#include <sstream>
#include <utility>

namespace lagrain {
namespace {

// ---------------------------------------------------------------------------------------- words

template <class E>
struct Word {
  std::string_view text;
  E value;
};

constexpr std::array kNormalWords{Word<NormalModel>{"linear", NormalModel::linear},
                                  Word<NormalModel>{"hertz", NormalModel::hertz}};
constexpr std::array kFrictionWords{Word<FrictionModel>{"none", FrictionModel::none},
                                    Word<FrictionModel>{"viscous", FrictionModel::viscous},
                                    Word<FrictionModel>{"elastic", FrictionModel::elastic}};
constexpr std::array kIntegratorWords{
    Word<IntegratorModel>{"velocity Verlet", IntegratorModel::velocity_verlet},
    Word<IntegratorModel>{"symplectic Euler", IntegratorModel::symplectic_euler},
    Word<IntegratorModel>{"fourth order", IntegratorModel::fourth_order}};
constexpr std::array kNeighbourhoodWords{
    Word<NeighbourhoodModel>{"triangulation", NeighbourhoodModel::triangulation},
    Word<NeighbourhoodModel>{"linked cells", NeighbourhoodModel::linked_cells},
    Word<NeighbourhoodModel>{"all pairs", NeighbourhoodModel::all_pairs}};
constexpr std::array kArrangementWords{Word<Arrangement>{"lattice", Arrangement::lattice},
                                       Word<Arrangement>{"random", Arrangement::random}};

template <class Words, class E>
std::string_view text_of(const Words& words, E value) {
  return std::find_if(words.begin(), words.end(), [&](const auto& w) { return w.value == value; })
      ->text;
}

/// Letters to insert, delete or replace to turn one word into the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// ` (did you mean "x"?)` for the word most like `word`, or nothing if none is like it.
std::string suggestion(std::string_view word, const std::vector<std::string>& known) {
  std::size_t best = std::max<std::size_t>(2, word.size() / 2) + 1;
  std::string_view nearest;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest.empty() ? "" : " (did you mean \"" + std::string(nearest) + "\"?)";
}

// --------------------------------------------------------------------------------------- errors

/// What stands in the file, as a message shows it.
std::string shown(const toml::node& node) {
  if (const auto* s = node.as_string()) return "\"" + s->get() + "\"";
  if (const auto* i = node.as_integer()) return std::to_string(i->get());
  if (const auto* f = node.as_floating_point()) return shortest(f->get());
  if (const auto* b = node.as_boolean()) return b->get() ? "true" : "false";
  if (const auto* a = node.as_array()) {
    std::string text = "[";
    for (const toml::node& item : *a) {
      if (text.size() > 1) text += ", ";
      text += shown(item);
    }
    return text += ']';
  }
  if (node.is_table()) return "a table";
  return "a date or time";
}

struct File {
  std::string name;
  std::map<std::string, int>* lines;

  [[noreturn]] void fail(const toml::node& node, const std::string& path,
                         const std::string& message) const {
    throw SceneError(name + ":" + std::to_string(node.source().begin.line) + ": " + path + ": " +
                     message);
  }
  [[noreturn]] void expected(const toml::node& node, const std::string& path,
                             const std::string& what) const {
    fail(node, path, "expected " + what + ", got " + shown(node));
  }
};

// ----------------------------------------------------------------------------------- quantities

/// What a key asks for.
struct Kind {
  const char* what;  ///< with its article
  Unit unit;
};

constexpr Kind kNumber{"a number", {}};
constexpr Kind kLength{"a length", {1, 0, 0}};
constexpr Kind kTime{"a time", {0, 0, 1}};
constexpr Kind kMass{"a mass", {0, 1, 0}};
constexpr Kind kFrequency{"a frequency", {0, 0, -1}};
constexpr Kind kSpin{"an angular velocity", {0, 0, -1}};
constexpr Kind kSpeed{"a speed", {1, 0, -1}};
constexpr Kind kAcceleration{"an acceleration", {1, 0, -2}};
constexpr Kind kForce{"a force", {1, 1, -2}};
constexpr Kind kStiffness{"a stiffness", {0, 1, -2}};
constexpr Kind kModulus{"a modulus", {-1, 1, -2}};
constexpr Kind kDensity{"a density", {-3, 1, 0}};

enum class Range { any, not_negative, positive };

std::string described(const Kind& kind, Range range) {
  const std::string_view what = kind.what;
  const std::string_view noun = what.substr(what.find(' ') + 1);
  std::string text = range == Range::any        ? std::string(what)
                     : range == Range::positive ? "a positive " + std::string(noun)
                                                : std::string(what) + " that is not negative";
  if (kind.unit != Unit{}) text += " [" + to_string(kind.unit) + "]";
  return text;
}

double quantity(const File& file, const toml::node& node, const std::string& path, const Kind& kind,
                Range range) {
  double value = 0;
  if (const auto* s = node.as_string()) {
    Quantity q;
    try {
      q = parse_quantity(s->get());
    } catch (const std::invalid_argument& reason) {
      file.fail(
          node, path,
          "expected " + described(kind, range) + ", got " + shown(node) + ": " + reason.what());
    }
    if (q.unit != kind.unit) file.expected(node, path, described(kind, range));
    value = q.value;
  } else if (const auto* i = node.as_integer()) {
    value = static_cast<double>(i->get());
  } else if (const auto* f = node.as_floating_point()) {
    value = f->get();
  } else {
    file.expected(node, path, described(kind, range));
  }
  const bool in_range =
      range == Range::any || value > 0 || (range != Range::positive && value == 0);
  if (!std::isfinite(value) || !in_range) file.expected(node, path, described(kind, range));
  return value;
}

template <int N>
Eigen::Matrix<double, N, 1> quantities(const File& file, const toml::node& node,
                                       const std::string& path, const Kind& kind) {
  const auto* array = node.as_array();
  if (array == nullptr || array->size() != static_cast<std::size_t>(N)) {
    file.expected(node, path,
                  "[" + std::string(N == 2 ? "x, y" : "x, y, z") + "], each " + kind.what +
                      (kind.unit == Unit{} ? "" : " [" + to_string(kind.unit) + "]"));
  }
  Eigen::Matrix<double, N, 1> v;
  for (int d = 0; d < N; ++d) {
    v[d] = quantity(file, *array->get(static_cast<std::size_t>(d)), path, kind, Range::any);
  }
  return v;
}

// --------------------------------------------------------------------------------------- tables

/// One table of the file. It remembers which keys were asked for; `finish` refuses the others.
class Section {
 public:
  Section(const File& file, const toml::table& table, std::string path)
      : file_(file), table_(table), path_(std::move(path)) {}

  const File& file() const { return file_; }
  const toml::table& table() const { return table_; }
  std::string path(std::string_view key) const {
    return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
  }

  const toml::node* find(std::string_view key) {
    known_.emplace_back(key);
    const toml::node* node = table_.get(key);
    if (node != nullptr) {
      (*file_.lines)[path(key)] = static_cast<int>(node->source().begin.line);
    }
    return node;
  }
  const toml::node& require(std::string_view key, const std::string& what) {
    const toml::node* node = find(key);
    if (node == nullptr) {
      // A misspelt key explains the missing one better than its absence does.
      std::string hint;
      for (const auto& [other, value] : table_) {
        if (edit_distance(other.str(), key) <= 2 &&
            std::find(known_.begin(), known_.end(), other.str()) == known_.end()) {
          hint = " (is \"" + std::string(other.str()) + "\" on line " +
                 std::to_string(other.source().begin.line) + " meant?)";
        }
      }
      file_.fail(table_, path(key), "missing; expected " + what + hint);
    }
    return *node;
  }

  /// A known key that makes no sense here.
  void refuse(std::string_view key, const std::string& why) {
    if (const toml::node* node = find(key)) file_.fail(*node, path(key), why);
  }

  double number(std::string_view key, const Kind& kind, Range range) {
    return quantity(file_, require(key, described(kind, range)), path(key), kind, range);
  }
  double number(std::string_view key, const Kind& kind, Range range, double fallback) {
    const toml::node* node = find(key);
    return node ? quantity(file_, *node, path(key), kind, range) : fallback;
  }
  template <int N>
  Eigen::Matrix<double, N, 1> vector(std::string_view key, const Kind& kind) {
    return quantities<N>(file_, require(key, N == 2 ? "[x, y]" : "[x, y, z]"), path(key), kind);
  }
  std::int64_t integer(std::string_view key, std::int64_t least, std::int64_t fallback) {
    const toml::node* node = find(key);
    if (node == nullptr) return fallback;
    const auto* value = node->as_integer();
    if (value == nullptr || value->get() < least) {
      file_.expected(*node, path(key), "a whole number, at least " + std::to_string(least));
    }
    return value->get();
  }
  bool flag(std::string_view key, bool fallback) {
    const toml::node* node = find(key);
    if (node == nullptr) return fallback;
    if (!node->is_boolean()) file_.expected(*node, path(key), "true or false");
    return node->as_boolean()->get();
  }
  std::string text(std::string_view key, const std::string& fallback) {
    const toml::node* node = find(key);
    if (node == nullptr) return fallback;
    return text_of_node(key, *node);
  }
  std::string text(std::string_view key) { return text_of_node(key, require(key, "text")); }
  template <class E, std::size_t N>
  E word(std::string_view key, const std::array<Word<E>, N>& words, std::optional<E> fallback) {
    std::string all;
    for (std::size_t k = 0; k < N; ++k) {
      all += (k == 0       ? ""
              : k + 1 == N ? " or "
                           : ", ") +
             ("\"" + std::string(words[k].text) + "\"");
    }
    const toml::node* node = fallback ? find(key) : &require(key, all);
    if (node == nullptr) return *fallback;
    if (const auto* s = node->as_string()) {
      for (const auto& candidate : words) {
        if (candidate.text == s->get()) return candidate.value;
      }
    }
    file_.expected(*node, path(key), all);
  }
  /// A table that must be there, or may be missing.
  const toml::table* sub_table(std::string_view key) {
    const toml::node* node = find(key);
    if (node == nullptr) return nullptr;
    if (!node->is_table()) file_.expected(*node, path(key), "a table");
    return node->as_table();
  }
  /// Visits each table of [[key]]: f(section, index).
  template <class F>
  void for_each(std::string_view key, F&& f) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto* array = node->as_array();
    if (array == nullptr) {
      file_.fail(*node, path(key), "expected tables headed [[" + std::string(key) + "]]");
    }
    int index = 0;
    for (const toml::node& item : *array) {
      const std::string here = path(key) + "[" + std::to_string(index) + "]";
      if (!item.is_table()) file_.expected(item, here, "a table");
      (*file_.lines)[here] = static_cast<int>(item.source().begin.line);
      Section section(file_, *item.as_table(), here);
      f(section, index);
      section.finish();
      ++index;
    }
  }

  void finish() const {
    for (const auto& [key, node] : table_) {
      if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
      throw SceneError(file_.name + ":" + std::to_string(key.source().begin.line) + ": " +
                       path(key.str()) + ": unknown key" + suggestion(key.str(), known_));
    }
  }

 private:
  std::string text_of_node(std::string_view key, const toml::node& node) const {
    if (!node.is_string()) file_.expected(node, path(key), "text");
    return node.as_string()->get();
  }

  const File& file_;
  const toml::table& table_;
  std::string path_;
  std::vector<std::string> known_;
};

// ---------------------------------------------------------------------------------------- parts

TimeStep read_time_step(Section& top) {
  TimeStep step;
  const toml::node* node = top.find("time_step");
  if (node == nullptr) return step;
  const std::string what = "a fraction of contact time (\"1/25 contact\") or a time";
  const std::string path = top.path("time_step");
  if (const auto* s = node->as_string()) {
    std::string_view text = s->get();
    constexpr std::string_view kUnit = "contact";
    if (text.size() > kUnit.size() && text.substr(text.size() - kUnit.size()) == kUnit) {
      text.remove_suffix(kUnit.size());
      while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
      double parts[2] = {0, 1};
      const char* at = text.data();
      const char* const end = at + text.size();
      bool good = true;
      for (int k = 0; k < 2 && good; ++k) {
        const auto [stop, bad] = std::from_chars(at, end, parts[k]);
        good = bad == std::errc{};
        at = stop;
        if (at == end) break;
        good = good && k == 0 && *at == '/';
        ++at;
      }
      const double fraction = parts[0] / parts[1];
      if (!good || at != end || !std::isfinite(fraction) || fraction <= 0) {
        top.file().expected(*node, path, what);
      }
      step.fraction_of_contact = fraction;
      return step;
    }
    Quantity q;
    try {
      q = parse_quantity(text);
    } catch (const std::invalid_argument&) {
      top.file().expected(*node, path, what);
    }
    if (q.unit != kTime.unit) top.file().expected(*node, path, what);
  } else if (!node->is_number()) {
    top.file().expected(*node, path, what);
  }
  step.seconds = quantity(top.file(), *node, path, kTime, Range::positive);
  return step;
}

/// Reads the numbers of a law. Those that the model does not use are refused; with `base`, none is
/// required and the missing ones are taken from there.
LawNumbers read_law(Section& s, NormalModel normal, FrictionModel friction,
                    const LawNumbers* base) {
  LawNumbers law = base ? *base : LawNumbers{};
  const auto number = [&](const char* key, const Kind& kind, Range range, double& value) {
    value = base ? s.number(key, kind, range, value) : s.number(key, kind, range);
  };
  const std::string unused = " does not use it; remove this line";
  if (normal == NormalModel::linear) {
    number("stiffness", kStiffness, Range::positive, law.stiffness);
    s.refuse("modulus", "normal = \"linear\"" + unused + " or choose \"hertz\"");
    s.refuse("impact_speed", "normal = \"linear\"" + unused + " or choose \"hertz\"");
  } else {
    number("modulus", kModulus, Range::positive, law.modulus);
    number("impact_speed", kSpeed, Range::positive, law.impact_speed);
    s.refuse("stiffness", "normal = \"hertz\"" + unused + " or choose \"linear\"");
  }
  number("restitution", kNumber, Range::positive, law.restitution);
  if (law.restitution > 1) {
    s.file().expected(*s.find("restitution"), s.path("restitution"),
                      "a number above 0 and at most 1");
  }
  const std::string other = " or choose \"viscous\" or \"elastic\"";
  if (friction == FrictionModel::none) {
    s.refuse("friction", "a scene with friction = \"none\"" + unused + other);
    s.refuse("tangential_damping", "a scene with friction = \"none\"" + unused + other);
    s.refuse("stiffness_ratio", "a scene with friction = \"none\"" + unused + other);
    return law;
  }
  number("friction", kNumber, Range::not_negative, law.friction);
  if (!base && friction == FrictionModel::viscous) law.tangential_damping = 0.15;
  law.tangential_damping =
      s.number("tangential_damping", kNumber, Range::not_negative, law.tangential_damping);
  if (friction == FrictionModel::elastic) {
    law.stiffness_ratio =
        s.number("stiffness_ratio", kNumber, Range::positive, law.stiffness_ratio);
  } else {
    s.refuse("stiffness_ratio", "friction = \"viscous\"" + unused + " or choose \"elastic\"");
    if (law.tangential_damping == 0) {
      s.file().fail(s.table(), s.path("tangential_damping"),
                    "friction = \"viscous\" acts through it: expected a positive number, got 0");
    }
  }
  return law;
}

RadiusLaw read_radius(Section& s) {
  const std::string path = s.path("radius");
  const toml::node& node = s.require("radius", described(kLength, Range::positive));
  if (!node.is_table()) return quantity(s.file(), node, path, kLength, Range::positive);
  Section inner(s.file(), *node.as_table(), path);
  if (inner.find("uniform") == nullptr && inner.find("values") == nullptr) {
    inner.finish();
    s.file().fail(node, path, "expected uniform = [low, high] or values = [...]");
  }
  const auto list = [&](const char* key, const Kind& kind, Range range) {
    const toml::node& item = inner.require(key, "a list");
    const auto* array = item.as_array();
    if (array == nullptr || array->empty()) {
      s.file().expected(item, inner.path(key), "a list of numbers");
    }
    std::vector<double> values;
    for (const toml::node& v : *array) {
      values.push_back(quantity(s.file(), v, inner.path(key), kind, range));
    }
    return values;
  };
  RadiusLaw law;
  if (inner.find("uniform") != nullptr) {
    const auto bounds = list("uniform", kLength, Range::positive);
    if (bounds.size() != 2 || bounds[0] > bounds[1]) {
      s.file().expected(*inner.find("uniform"), inner.path("uniform"), "[smallest, largest]");
    }
    inner.refuse("values", "either uniform or values");
    inner.refuse("weights", "weights belong to values");
    law = UniformRadius{bounds[0], bounds[1]};
  } else {
    ListedRadius listed;
    listed.values = list("values", kLength, Range::positive);
    listed.weights = inner.find("weights") ? list("weights", kNumber, Range::not_negative)
                                           : std::vector<double>(listed.values.size(), 1.0);
    if (listed.weights.size() != listed.values.size() ||
        std::accumulate(listed.weights.begin(), listed.weights.end(), 0.0) <= 0) {
      s.file().fail(node, path, "expected as many weights as values, not all 0");
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
    top_.for_each("fill", [&](Section& s, int) { read_fill(s); });
    top_.for_each("grain", [&](Section& s, int) { read_grain(s); });
    top_.for_each("wall", [&](Section& s, int index) { read_wall(s, index); });
    top_.for_each("box", [&](Section& s, int) { read_box(s); });
    read_output();
    top_.finish();
    if (scene_.fills.empty() && scene_.grains.empty()) {
      throw SceneError(file_.name + ": no grains: expected at least one [[fill]] or [[grain]]");
    }
    return std::move(scene_);
  }

 private:
  void read_top() {
    top_.find("dimension");  // checked before this reader was chosen
    std::string stem = std::filesystem::path(file_.name).stem().string();
    scene_.title = top_.text("title", stem);
    scene_.seed = static_cast<std::uint64_t>(top_.integer("seed", 0, 1));
    scene_.duration = top_.number("duration", kTime, Range::positive);
    scene_.time_step = read_time_step(top_);
    scene_.gravity = top_.vector<Dim>("gravity", kAcceleration);
    if (Dim == 2) {
      scene_.depth = top_.number("depth", kLength, Range::positive, 1);
    } else {
      top_.refuse("depth", "spheres have none; remove this line");
    }
    scene_.normal = top_.word<NormalModel>("normal", kNormalWords, {});
    scene_.friction = top_.word<FrictionModel>("friction", kFrictionWords, {});
    scene_.integrator =
        top_.word<IntegratorModel>("integrator", kIntegratorWords, scene_.integrator);
    scene_.neighbourhood =
        top_.word<NeighbourhoodModel>("neighbourhood", kNeighbourhoodWords, scene_.neighbourhood);
    scene_.largest_overlap =
        top_.number("largest_overlap", kNumber, Range::positive, scene_.largest_overlap);
    scene_.largest_initial_overlap = top_.number(
        "largest_initial_overlap", kNumber, Range::not_negative, scene_.largest_initial_overlap);
    scene_.audit = top_.flag("audit", false);
    if (scene_.audit) {
      scene_.audit_every = static_cast<int>(top_.integer("audit_every", 1, scene_.audit_every));
    } else {
      top_.refuse("audit_every", "nothing is audited; add audit = true or remove this line");
    }
  }

  void read_materials() {
    const toml::table* table = top_.sub_table("materials");
    if (table == nullptr || table->empty()) {
      throw SceneError(file_.name + ": materials: missing; expected at least one [materials.NAME]");
    }
    if (table->size() > 255) {
      file_.fail(*table, "materials", "expected at most 255, got " + std::to_string(table->size()));
    }
    std::vector<std::pair<toml::source_position, std::string>> order;
    for (const auto& [key, node] : *table) {
      order.emplace_back(key.source().begin, std::string(key.str()));
    }
    std::sort(order.begin(), order.end());
    Section all(file_, *table, "materials");
    for (const auto& [at, name] : order) {
      Section s(file_, *all.sub_table(name), "materials." + name);
      scene_.materials.push_back({name, s.number("density", kDensity, Range::positive, 0)});
      s.finish();
    }
  }

  int material(Section& s, std::string_view key, bool with_density) {
    int found = 0;
    if (scene_.materials.size() > 1 || s.table().contains(key)) {
      found = material_named(s.text(key), *s.find(key), s.path(key));
    } else {
      s.find(key);
    }
    if (with_density && scene_.materials[static_cast<std::size_t>(found)].density == 0) {
      const std::string& name = scene_.materials[static_cast<std::size_t>(found)].name;
      file_.fail(s.table(), s.path(key),
                 "grains of \"" + name + "\" need [materials." + name + "] density");
    }
    return found;
  }
  int material_named(const std::string& name, const toml::node& node, const std::string& path) {
    std::vector<std::string> names;
    for (std::size_t m = 0; m < scene_.materials.size(); ++m) {
      if (scene_.materials[m].name == name) return static_cast<int>(m);
      names.push_back(scene_.materials[m].name);
    }
    file_.fail(node, path, "no material \"" + name + "\"" + suggestion(name, names));
  }

  void read_laws() {
    const toml::table* table = top_.sub_table("law");
    if (table == nullptr) throw SceneError(file_.name + ": law: missing; expected a table [law]");
    Section s(file_, *table, "law");
    scene_.law = read_law(s, scene_.normal, scene_.friction, nullptr);
    s.finish();
    top_.for_each("pair", [&](Section& pair, int) {
      const toml::node& node = pair.require("between", "two materials");
      const auto* names = node.as_array();
      if (names == nullptr || names->size() != 2 || !names->get(0)->is_string() ||
          !names->get(1)->is_string()) {
        file_.expected(node, pair.path("between"), "two materials");
      }
      PairLaw law;
      law.a = material_named(names->get(0)->as_string()->get(), node, pair.path("between"));
      law.b = material_named(names->get(1)->as_string()->get(), node, pair.path("between"));
      if (law.a > law.b) std::swap(law.a, law.b);
      for (const PairLaw& earlier : scene_.pairs) {
        if (earlier.a == law.a && earlier.b == law.b) {
          file_.fail(node, pair.path("between"), "a second time " + shown(node));
        }
      }
      law.law = read_law(pair, scene_.normal, scene_.friction, &scene_.law);
      scene_.pairs.push_back(law);
    });
    if (scene_.integrator == IntegratorModel::fourth_order) {
      const std::string why = "\"fourth order\" is for forces without loss: it needs ";
      const toml::node& node = *top_.find("integrator");
      if (scene_.friction != FrictionModel::none) {
        file_.fail(node, "integrator", why + "friction = \"none\"");
      }
      bool lossless = scene_.law.restitution == 1;
      for (const PairLaw& p : scene_.pairs) lossless = lossless && p.law.restitution == 1;
      if (!lossless) file_.fail(node, "integrator", why + "restitution = 1");
    }
  }

  void read_fill(Section& s) {
    Fill<Dim> fill;
    fill.name = s.text("name", "fill " + std::to_string(scene_.fills.size() + 1));
    fill.material = material(s, "material", true);
    fill.arrangement = s.word<Arrangement>("arrangement", kArrangementWords, fill.arrangement);
    if (fill.arrangement == Arrangement::random) s.require("count", "a number of grains");
    if (s.find("count")) {
      const std::int64_t count = s.integer("count", 1, 1);
      if (count > kMostGrains) {
        file_.expected(*s.find("count"), s.path("count"),
                       "at most " + std::to_string(kMostGrains) + " grains");
      }
      fill.count = static_cast<int>(count);
    }
    fill.radius = read_radius(s);
    const toml::node& region = s.require("region", "{ low = [...], high = [...] }");
    if (!region.is_table()) {
      file_.expected(region, s.path("region"), "{ low = [...], high = [...] }");
    }
    Section box(file_, *region.as_table(), s.path("region"));
    fill.low = box.vector<Dim>("low", kLength);
    fill.high = box.vector<Dim>("high", kLength);
    box.finish();
    if (!(fill.low.array() < fill.high.array()).all()) {
      file_.fail(region, s.path("region"), "expected low below high in every direction");
    }
    if (const toml::node* v = s.find("velocity")) {
      if (v->is_table()) {
        Section inner(file_, *v->as_table(), s.path("velocity"));
        fill.random_speed = inner.number("random", kSpeed, Range::not_negative);
        inner.finish();
      } else {
        fill.velocity = quantities<Dim>(file_, *v, s.path("velocity"), kSpeed);
      }
    }
    scene_.fills.push_back(std::move(fill));
  }

  void read_grain(Section& s) {
    PlacedGrain<Dim> grain;
    grain.position = s.vector<Dim>("position", kLength);
    grain.radius = s.number("radius", kLength, Range::positive);
    grain.material = material(s, "material", true);
    grain.pinned = s.flag("pinned", false);
    if (grain.pinned) {
      s.refuse("velocity", "a pinned grain stays; remove this line");
      s.refuse("spin", "a pinned grain stays; remove this line");
    }
    if (const toml::node* v = s.find("velocity")) {
      grain.velocity = quantities<Dim>(file_, *v, s.path("velocity"), kSpeed);
    }
    if (scene_.friction == FrictionModel::none) {
      s.refuse("spin", "nothing spins in a scene with friction = \"none\"; remove this line");
    } else if (const toml::node* w = s.find("spin")) {
      if constexpr (Dim == 2) {
        grain.spin[0] = quantity(file_, *w, s.path("spin"), kSpin, Range::any);
      } else {
        grain.spin = quantities<Dim>(file_, *w, s.path("spin"), kSpin);
      }
    }
    scene_.grains.push_back(grain);
  }

  void read_wall(Section& s, int index) {
    const std::string name = s.text("name", "wall " + std::to_string(index + 1));
    const int kind = material(s, "material", false);
    Wall<Dim> wall;
    if (s.find("radius")) {
      wall = read_cylinder(s, name);
    } else if (s.find("point") || s.find("normal")) {
      const Vec<Dim> point = s.vector<Dim>("point", kLength);
      const Vec<Dim> normal = s.vector<Dim>("normal", kNumber);
      if (normal.isZero(0)) file_.expected(*s.find("normal"), s.path("normal"), "a direction");
      s.refuse("from", "either point and normal, or from and to");
      s.refuse("to", "either point and normal, or from and to");
      s.refuse("axis", "an axis belongs to a round wall, with point and radius");
      wall = Wall<Dim>::half_space(name, point, normal);
      if (is_unit(normal)) wall.shape = HalfSpace<Dim>{normal};
    } else if (s.find("from") || s.find("to")) {
      const Vec<Dim> from = s.vector<Dim>("from", kLength);
      if (const toml::node* along = s.find("along")) {
        s.refuse("to", "either to or along");
        wall = Wall<Dim>::segment(name, from, from);
        wall.shape = WallSegment<Dim>{quantities<Dim>(file_, *along, s.path("along"), kLength)};
      } else {
        wall = Wall<Dim>::segment(name, from, s.vector<Dim>("to", kLength));
      }
      if (std::get<WallSegment<Dim>>(wall.shape).along.isZero(0)) {
        file_.fail(s.table(), s.path("to"), "expected another point than from");
      }
    } else {
      s.finish();
      file_.fail(s.table(), s.path("point"),
                 "missing; expected point and normal, from and to, or point and radius");
    }
    add_wall(s, std::move(wall), kind, s.sub_table("motion"));
  }

  Wall<Dim> read_cylinder(Section& s, const std::string& name) {
    const double radius = s.number("radius", kLength, Range::positive);
    const Vec<Dim> point = s.vector<Dim>("point", kLength);
    for (const char* key : {"normal", "from", "to", "along"}) {
      s.refuse(key, "a round wall has point" + std::string(Dim == 3 ? ", axis" : "") +
                        " and radius; remove this line");
    }
    Vec<Dim> axis = Vec<Dim>::Zero();
    if (Dim == 2) {
      s.refuse("axis", "a circle has none; remove this line");
    } else {
      axis = s.vector<Dim>("axis", kNumber);
      if (axis.isZero(0)) file_.expected(*s.find("axis"), s.path("axis"), "a direction");
    }
    Wall<Dim> wall = Wall<Dim>::cylinder(name, point, axis, radius);
    if (is_unit(axis)) wall.shape = Cylinder<Dim>{radius, axis};
    return wall;
  }

  /// Sides of a box as walls of their own, called by the direction in which they lie.
  void read_box(Section& s) {
    const Vec<Dim> low = s.vector<Dim>("low", kLength);
    const Vec<Dim> high = s.vector<Dim>("high", kLength);
    if (!(low.array() < high.array()).all()) {
      file_.fail(s.table(), s.path("high"), "expected low below high in every direction");
    }
    const std::string prefix = s.text("name", "");
    const int kind = material(s, "material", false);
    std::vector<std::string> sides{"left", "right"};
    if (Dim == 3) sides.insert(sides.end(), {"front", "back"});
    sides.insert(sides.end(), {"bottom", "top"});
    std::vector<bool> open(sides.size(), false);
    if (const toml::node* node = s.find("open")) {
      const auto* array = node->as_array();
      if (array == nullptr) file_.expected(*node, s.path("open"), "a list of sides");
      for (const toml::node& item : *array) {
        if (!item.is_string()) file_.expected(item, s.path("open"), "a side");
        const std::string& side = item.as_string()->get();
        const auto found = std::find(sides.begin(), sides.end(), side);
        if (found == sides.end()) {
          file_.fail(item, s.path("open"),
                     "no side \"" + side + "\"" + suggestion(side, sides) +
                         "; expected some of left, right, " + (Dim == 3 ? "front, back, " : "") +
                         "bottom, top");
        }
        open[static_cast<std::size_t>(found - sides.begin())] = true;
      }
    }
    const toml::table* motion = s.sub_table("motion");
    for (std::size_t k = 0; k < sides.size(); ++k) {
      if (open[k]) continue;
      Vec<Dim> inwards = Vec<Dim>::Zero();
      inwards[static_cast<Eigen::Index>(k / 2)] = k % 2 == 0 ? 1 : -1;
      const std::string name = prefix.empty() ? sides[k] : prefix + " " + sides[k];
      Wall<Dim> wall = Wall<Dim>::half_space(name, k % 2 == 0 ? low : high, inwards);
      add_wall(s, std::move(wall), kind, motion);
      if (std::holds_alternative<Piston<Dim>>(scene_.walls.back().motion)) {
        file_.fail(*motion, s.path("motion"),
                   "each side would move for itself; leave the side open and give the piston as a "
                   "[[wall]]");
      }
    }
  }

  void add_wall(Section& s, Wall<Dim> wall, int kind, const toml::table* motion) {
    for (const Wall<Dim>& other : scene_.walls) {
      if (other.name == wall.name) {
        file_.fail(s.table(), s.path("name"), "a second \"" + wall.name + "\"");
      }
    }
    wall.kind = kind;
    if (motion != nullptr) read_motion(s, *motion, wall);
    scene_.walls.push_back(std::move(wall));
  }

  /// Normalising a unit vector again may change its last bit; a resolved scene must not.
  static bool is_unit(const Vec<Dim>& v) { return std::abs(v.squaredNorm() - 1) < 1e-14; }

  void read_motion(Section& parent, const toml::table& table, Wall<Dim>& wall) {
    Section s(file_, table, parent.path("motion"));
    enum class Type { steady, shake, piston };
    constexpr std::array kWords{Word<Type>{"steady", Type::steady},
                                Word<Type>{"shake", Type::shake},
                                Word<Type>{"piston", Type::piston}};
    const Type type = s.word<Type>("type", kWords, {});
    if (scene_.integrator == IntegratorModel::fourth_order) {
      file_.fail(table, s.path("type"),
                 "integrator = \"fourth order\" needs walls at rest; remove this motion");
    }
    const auto times = [&](double& start, double& stop) {
      start = s.number("start", kTime, Range::not_negative, 0);
      stop = s.number("stop", kTime, Range::positive, stop);
      if (!(start < stop)) {
        file_.fail(*s.find("stop"), s.path("stop"), "expected a time after start");
      }
    };
    if (type == Type::steady) {
      Steady<Dim> m;
      m.velocity = s.vector<Dim>("velocity", kSpeed);
      times(m.start, m.stop);
      wall.motion = m;
    } else if (type == Type::shake) {
      Shake<Dim> m;
      m.amplitude = s.vector<Dim>("amplitude", kLength);
      m.frequency = s.number("frequency", kFrequency, Range::positive);
      times(m.start, m.stop);
      wall.motion = m;
    } else {
      Piston<Dim> m{};
      m.mass = s.number("mass", kMass, Range::positive);
      m.load = s.vector<Dim>("load", kForce);
      if (m.load.isZero(0)) {
        file_.expected(*s.find("load"), s.path("load"), "a force: the piston moves along it");
      }
      m.start = s.number("start", kTime, Range::not_negative, 0);
      s.refuse("stop", "a piston has none: grains stop it; remove this line");
      wall.motion = m;
    }
    s.finish();
  }

  void read_output() {
    if (const toml::table* table = top_.sub_table("output")) {
      Section s(file_, *table, "output");
      scene_.output.frames_every = s.number("frames_every", kTime, Range::positive, 0);
      scene_.output.series_every = s.number("series_every", kTime, Range::positive, 0);
      scene_.output.contacts = s.flag("contacts", false);
      s.finish();
    }
  }

  static constexpr int kMostGrains = 100'000'000;

  Scene<Dim> scene_;
  File file_;
  Section top_;
};

toml::table parsed(std::string_view text, const std::string& name) {
  try {
    return toml::parse(text, std::string_view(name));
  } catch (const toml::parse_error& error) {
    std::string reason(error.description());
    if (!reason.empty() && reason.back() == '.') reason.pop_back();
    throw SceneError(name + ":" + std::to_string(error.source().begin.line) + ":" +
                     std::to_string(error.source().begin.column) + ": not valid TOML: " + reason);
  }
}

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
std::string called(const std::filesystem::path& file) {
  return file.filename().string();
}

int dimension_of(const toml::table& root, const std::string& name) {
  const toml::node* node = root.get("dimension");
  if (node == nullptr) throw SceneError(name + ": dimension: missing; expected 2 or 3");
  const auto* value = node->as_integer();
  if (value == nullptr || (value->get() != 2 && value->get() != 3)) {
    File{name, nullptr}.expected(*node, "dimension", "2 or 3");
  }
  return static_cast<int>(value->get());
}

// -------------------------------------------------------------------------------------- writing

/// A number that TOML reads as the same one: a long row of digits would be too large an integer,
/// and an integer has no negative zero.
std::string number(double value) {
  std::string text = shortest(value);
  const bool fails_as_integer = std::abs(value) >= 1e15 || (value == 0 && std::signbit(value));
  if (fails_as_integer && text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

template <class V>
std::string list(const V& v) {
  std::string text = "[";
  for (const double x : v) {
    if (text.size() > 1) text += ", ";
    text += number(x);
  }
  return text += ']';
}

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      constexpr std::string_view kHex = "0123456789ABCDEF";
      const auto code = static_cast<unsigned char>(c);
      out += "\\u00";
      out += kHex[code / 16];
      out += kHex[code % 16];
    } else {
      out += c;
    }
  }
  return out + "\"";
}

void write_law(std::string& out, const LawNumbers& law, NormalModel normal,
               FrictionModel friction) {
  const auto line = [&](const char* key, double value, const char* unit) {
    out += std::string(key) + " = " + number(value) + "  # " + unit + "\n";
  };
  if (normal == NormalModel::linear) {
    line("stiffness", law.stiffness, "N/m");
  } else {
    line("modulus", law.modulus, "Pa");
    line("impact_speed", law.impact_speed, "m/s");
  }
  line("restitution", law.restitution, "-");
  if (friction == FrictionModel::none) return;
  line("friction", law.friction, "-");
  line("tangential_damping", law.tangential_damping, "-");
  if (friction == FrictionModel::elastic) line("stiffness_ratio", law.stiffness_ratio, "-");
}

std::string radius_text(const RadiusLaw& law) {
  if (const auto* r = std::get_if<double>(&law)) return number(*r);
  if (const auto* u = std::get_if<UniformRadius>(&law)) {
    return "{ uniform = [" + number(u->low) + ", " + number(u->high) + "] }";
  }
  const auto& listed = std::get<ListedRadius>(law);
  return "{ values = " + list(listed.values) + ", weights = " + list(listed.weights) + " }";
}

template <int Dim>
std::string motion_text(const Wall<Dim>& wall) {
  std::string text;
  const auto times = [&](double start, double stop) {
    text += ", start = " + number(start);
    if (std::isfinite(stop)) text += ", stop = " + number(stop);
  };
  if (const auto* m = std::get_if<Steady<Dim>>(&wall.motion)) {
    text = "type = \"steady\", velocity = " + list(m->velocity);
    times(m->start, m->stop);
  } else if (const auto* shake = std::get_if<Shake<Dim>>(&wall.motion)) {
    text = "type = \"shake\", amplitude = " + list(shake->amplitude) +
           ", frequency = " + number(shake->frequency);
    times(shake->start, shake->stop);
  } else if (const auto* piston = std::get_if<Piston<Dim>>(&wall.motion)) {
    text = "type = \"piston\", mass = " + number(piston->mass) + ", load = " + list(piston->load) +
           ", start = " + number(piston->start);
  }
  return text.empty() ? "" : "motion = { " + text + " }\n";
}

}  // namespace

std::string shortest(double value) {
  // TOML and CSV readers both know these words.
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  std::array<char, 32> buffer;
  const auto [end, failure] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), failure == std::errc{} ? end : buffer.data()};
}

std::string_view name_of(NormalModel model) {
  return text_of(kNormalWords, model);
}
std::string_view name_of(FrictionModel model) {
  return text_of(kFrictionWords, model);
}
std::string_view name_of(IntegratorModel model) {
  return text_of(kIntegratorWords, model);
}
std::string_view name_of(NeighbourhoodModel model) {
  return text_of(kNeighbourhoodWords, model);
}

int scene_dimension(const std::filesystem::path& file) {
  return dimension_of(parsed(whole_file(file), called(file)), called(file));
}

template <int Dim>
Scene<Dim> parse_scene(std::string_view text, const std::string& name) {
  const toml::table root = parsed(text, name);
  if (const int found = dimension_of(root, name); found != Dim) {
    File{name, nullptr}.fail(*root.get("dimension"), "dimension",
                             "expected " + std::to_string(Dim) + ", got " + std::to_string(found));
  }
  return Reader<Dim>(root, name).read();
}

template <int Dim>
Scene<Dim> read_scene(const std::filesystem::path& file) {
  return parse_scene<Dim>(whole_file(file), called(file));
}

template <int Dim>
std::string to_toml(const Scene<Dim>& scene) {
  std::string out;
  const auto line = [&](const std::string& key, const std::string& value, const char* unit = "") {
    out += key + " = " + value;
    if (*unit != '\0') out += std::string("  # ") + unit;
    out += "\n";
  };
  const auto material = [&](int index) {
    line("material", in_quotes(scene.materials[static_cast<std::size_t>(index)].name));
  };
  line("title", in_quotes(scene.title));
  line("dimension", std::to_string(Dim));
  line("seed", std::to_string(scene.seed));
  line("duration", number(scene.duration), "s");
  if (scene.time_step.seconds > 0) {
    line("time_step", number(scene.time_step.seconds), "s");
  } else {
    line("time_step", in_quotes(number(scene.time_step.fraction_of_contact) + " contact"));
  }
  line("gravity", list(scene.gravity), "m/s^2");
  if (Dim == 2) line("depth", number(scene.depth), "m");
  line("normal", in_quotes(name_of(scene.normal)));
  line("friction", in_quotes(name_of(scene.friction)));
  line("integrator", in_quotes(name_of(scene.integrator)));
  line("neighbourhood", in_quotes(name_of(scene.neighbourhood)));
  line("largest_overlap", number(scene.largest_overlap), "of the smaller radius");
  line("largest_initial_overlap", number(scene.largest_initial_overlap), "of the smaller radius");
  line("audit", scene.audit ? "true" : "false");
  if (scene.audit) line("audit_every", std::to_string(scene.audit_every), "steps");

  out += "\n[law]\n";
  write_law(out, scene.law, scene.normal, scene.friction);
  for (const Material& m : scene.materials) {
    out += "\n[materials." + in_quotes(m.name) + "]\n";
    if (m.density > 0) line("density", number(m.density), "kg/m^3");
  }
  for (const PairLaw& pair : scene.pairs) {
    out += "\n[[pair]]\n";
    line("between", "[" + in_quotes(scene.materials[static_cast<std::size_t>(pair.a)].name) + ", " +
                        in_quotes(scene.materials[static_cast<std::size_t>(pair.b)].name) + "]");
    write_law(out, pair.law, scene.normal, scene.friction);
  }
  for (const Fill<Dim>& fill : scene.fills) {
    out += "\n[[fill]]\n";
    line("name", in_quotes(fill.name));
    material(fill.material);
    if (fill.count) line("count", std::to_string(*fill.count));
    line("radius", radius_text(fill.radius), "m");
    line("region", "{ low = " + list(fill.low) + ", high = " + list(fill.high) + " }", "m");
    line("arrangement", in_quotes(text_of(kArrangementWords, fill.arrangement)));
    line("velocity",
         fill.random_speed > 0 ? "{ random = " + number(fill.random_speed) + " }"
                               : list(fill.velocity),
         "m/s");
  }
  for (const PlacedGrain<Dim>& grain : scene.grains) {
    out += "\n[[grain]]\n";
    line("position", list(grain.position), "m");
    line("radius", number(grain.radius), "m");
    material(grain.material);
    if (grain.pinned) {
      line("pinned", "true");
      continue;
    }
    line("velocity", list(grain.velocity), "m/s");
    if (scene.friction != FrictionModel::none) {
      line("spin", Dim == 2 ? number(grain.spin[0]) : list(grain.spin), "rad/s");
    }
  }
  for (const Wall<Dim>& wall : scene.walls) {
    out += "\n[[wall]]\n";
    line("name", in_quotes(wall.name));
    material(wall.kind);
    if (const auto* plane = std::get_if<HalfSpace<Dim>>(&wall.shape)) {
      line("point", list(wall.home), "m");
      line("normal", list(plane->normal));
    } else if (const auto* round = std::get_if<Cylinder<Dim>>(&wall.shape)) {
      line("point", list(wall.home), "m");
      if (Dim == 3) line("axis", list(round->axis));
      line("radius", number(round->radius), "m");
    } else {
      line("from", list(wall.home), "m");
      // `to` could not promise the same bits: to - from is rounded.
      line("along", list(std::get<WallSegment<Dim>>(wall.shape).along), "m");
    }
    out += motion_text(wall);
  }
  out += "\n[output]\n";
  if (scene.output.frames_every > 0) line("frames_every", number(scene.output.frames_every), "s");
  if (scene.output.series_every > 0) line("series_every", number(scene.output.series_every), "s");
  line("contacts", scene.output.contacts ? "true" : "false");
  return out;
}

template Scene<2> read_scene<2>(const std::filesystem::path&);
template Scene<3> read_scene<3>(const std::filesystem::path&);
template Scene<2> parse_scene<2>(std::string_view, const std::string&);
template Scene<3> parse_scene<3>(std::string_view, const std::string&);
template std::string to_toml<2>(const Scene<2>&);
template std::string to_toml<3>(const Scene<3>&);

}  // namespace lagrain
