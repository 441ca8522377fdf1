// SPDX-License-Identifier: GPL-3.0-or-later
#include "toml_table.hpp"

#include <lagrain/numbers.hpp>
#include <lagrain/words.hpp>

#include <cmath>
#include <stdexcept>

namespace lagrain::detail {
namespace {

/// What stands in the file, as a message shows it.
std::string shown(const toml::node& node) {
  constexpr std::size_t kLongest = 60;  // letters of a list
  if (const auto* s = node.as_string()) return lagrain::shown(s->get());
  if (const auto* i = node.as_integer()) return std::to_string(i->get());
  if (const auto* f = node.as_floating_point()) return shortest(f->get());
  if (const auto* b = node.as_boolean()) return b->get() ? "true" : "false";
  if (const auto* a = node.as_array()) {
    std::string text = "[";
    for (const toml::node& item : *a) {
      if (text.size() > 1) text += ", ";
      if (text.size() > kLongest) return text + "...]";
      text += shown(item);
    }
    return text += ']';
  }
  if (node.is_table()) return "a table";
  return "a date or time";
}

std::string unit_of(const Measure& measure) {
  return measure.unit == Unit{} ? "" : " [" + to_string(measure.unit) + "]";
}

/// Which numbers a key accepts, in words.
std::string described(const Key& key) {
  const std::string what(key.measure.what);
  const std::string unit = unit_of(key.measure);
  switch (key.range) {
    case Range::any:
      return what + unit;
    case Range::not_negative:
      return what + " that is not negative" + unit;
    case Range::positive:
      return "a positive " + what.substr(what.find(' ') + 1) + unit;
    case Range::fraction:
      return what + " above 0 and at most 1" + unit;
  }
  return {};
}

/// The word that was meant, as a hint: one that is spelled much like it, or one of ours for what
/// others call otherwise.
std::string hint_for(std::string_view word, const std::vector<std::string>& words) {
  struct Synonym {
    std::string_view theirs, ours;
  };
  constexpr std::array kSynonyms{Synonym{"coulomb", "elastic"},
                                 Synonym{"mindlin", "elastic"},
                                 Synonym{"hooke", "linear"},
                                 Synonym{"spring", "linear"},
                                 Synonym{"frictionless", "none"},
                                 Synonym{"leapfrog", "velocity Verlet"},
                                 Synonym{"grid", "linked cells"},
                                 Synonym{"grid", "lattice"},
                                 Synonym{"brute force", "all pairs"},
                                 Synonym{"delaunay", "triangulation"},
                                 Synonym{"regular", "lattice"},
                                 Synonym{"sinus", "shake"},
                                 Synonym{"sine", "shake"},
                                 Synonym{"volume", "mass"}};
  for (const Synonym& synonym : kSynonyms) {
    const std::string ours(synonym.ours);
    if (nearest_word(word, {std::string(synonym.theirs)}).empty()) continue;
    if (std::find(words.begin(), words.end(), ours) == words.end()) continue;
    return suggestion(ours, {ours});
  }
  return suggestion(word, words);
}

bool accepts(Range range, double value) {
  switch (range) {
    case Range::any:
      return std::isfinite(value);
    case Range::not_negative:
      return std::isfinite(value) && value >= 0;
    case Range::positive:
      return std::isfinite(value) && value > 0;
    case Range::fraction:
      return value > 0 && value <= 1;
  }
  return false;
}

/// What the parser says, in words that help whoever wrote the file.
std::string in_words(std::string_view reason) {
  constexpr std::string_view kPrefix = "Error while parsing ";
  std::string scope;
  if (const auto colon = reason.find(": "); reason.starts_with(kPrefix) && colon < reason.size()) {
    scope = reason.substr(kPrefix.size(), colon - kPrefix.size());
    reason.remove_prefix(colon + 2);
  }
  constexpr std::string_view kAgain = "cannot redefine existing ";
  if (reason.starts_with(kAgain)) {
    const auto first = std::min(reason.find('\''), reason.size() - 1);
    const auto last = reason.find('\'', first + 1);
    const std::string key(reason.substr(first + 1, last - first - 1));
    const std::string twice = lagrain::shown(key) + " stands here a second time";
    if (reason.find(" as ", last) < reason.size()) {
      return twice + ", as something else: a list of tables is headed [[" + shortened(key) +
             "]] each time, a single table [" + shortened(key) + "]";
    }
    const bool is_table = reason.substr(kAgain.size()).starts_with("table");
    return twice + (is_table ? "; a table has one heading" : "") +
           " (or does a heading such as [law] miss above this line?)";
  }
  if (reason.find("encountered end-of-file") < reason.size()) {
    return "the file ends within a " + scope;
  }
  if (!reason.empty() && reason.back() == '.') reason.remove_suffix(1);
  constexpr std::size_t kLongest = 200;
  return (scope.empty() || scope == "root table" ? "" : "in a " + scope + ": ") +
         shortened(reason, kLongest);
}

/// A name of too many parts would make tables within tables until the stack ends.
void expect_shallow(std::string_view text, const std::string& name) {
  constexpr int kMostParts = 1000;
  int parts = 1;
  int line = 1;
  for (const char c : text) {
    line += c == '\n' ? 1 : 0;
    parts = c == '.' ? parts + 1 : std::string_view(",[]{}=#\n").find(c) < 9 ? 1 : parts;
    if (parts <= kMostParts) continue;
    throw SceneError(name + ":" + std::to_string(line) + ": not valid TOML: a key of more than " +
                     std::to_string(kMostParts) + " parts");
  }
}

}  // namespace

std::string TomlFile::place_of(const toml::source_region& at) const {
  return is_own(at) ? name + ":" + std::to_string(at.begin.line) : *at.path;
}

void TomlFile::remember(const std::string& path, const toml::node& node) const {
  if (is_own(node.source())) (*lines)[path] = static_cast<int>(node.source().begin.line);
}

void TomlFile::fail(const toml::node& node, const std::string& path,
                    const std::string& message) const {
  throw SceneError(place_of(node.source()) + ": " + shortened(path, 100) + ": " + message);
}

void TomlFile::expected(const toml::node& node, const std::string& path,
                        const std::string& what) const {
  fail(node, path, "expected " + what + ", got " + shown(node));
}

toml::table parse_toml(std::string_view text, const std::string& name) {
  expect_shallow(text, name);
  try {
    return toml::parse(text, std::string_view(name));
  } catch (const toml::parse_error& error) {
    throw SceneError(name + ":" + std::to_string(error.source().begin.line) + ":" +
                     std::to_string(error.source().begin.column) +
                     ": not valid TOML: " + in_words(error.description()));
  }
}

// ------------------------------------------------------------------------------- finding a key

const toml::node* TomlTable::find(const Key& key) {
  known_.emplace_back(key.name);
  const toml::node* node = table_.get(key.name);
  if (node != nullptr) file_.remember(path(key), *node);
  return node;
}

const toml::node& TomlTable::require(const Key& key, const std::string& what) {
  if (const toml::node* node = find(key)) return *node;
  missing(key, what);
}

void TomlTable::missing(const Key& key, const std::string& what) {
  // A misspelt key explains the missing one better than its absence does.
  std::string hint;
  for (const auto& [other, value] : table_) {
    if (std::find(known_.begin(), known_.end(), other.str()) != known_.end()) continue;
    if (nearest_word(key.name, {std::string(other.str())}).empty()) continue;
    const toml::source_region& at = value.source();
    hint = " (is " + lagrain::shown(other.str()) +
           (file_.is_own(at) ? " on line " + std::to_string(at.begin.line)
                             : " of " + file_.place_of(at)) +
           " meant?)";
  }
  file_.fail(table_, path(key), "missing; expected " + what + hint);
}

void TomlTable::fail(const Key& key, const std::string& message) {
  const toml::node* node = find(key);
  file_.fail(node != nullptr ? *node : table_, path(key), message);
}

void TomlTable::expected(const Key& key, const std::string& what) {
  file_.expected(require(key, what), path(key), what);
}

void TomlTable::finish() const {
  for (const auto& [key, node] : table_) {
    if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
    throw SceneError(file_.place_of(key.source().path ? key.source() : node.source()) + ": " +
                     shortened(path(key.str()), 100) + ": unknown key" +
                     suggestion(key.str(), known_));
  }
}

std::vector<std::string> TomlTable::names() const {
  std::vector<std::pair<toml::source_position, std::string>> found;
  for (const auto& [key, node] : table_) {
    expect_name(node, path(key.str()), key.str());
    found.emplace_back(node.source().begin, key.str());
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> list;
  for (auto& [at, name] : found) list.push_back(std::move(name));
  return list;
}

// ------------------------------------------------------------------------------ reading a value

double TomlTable::quantity(const toml::node& node, const Key& key) const {
  double value = 0;
  if (const auto* s = node.as_string()) {
    Quantity q;
    try {
      q = parse_quantity(s->get());
    } catch (const std::invalid_argument& reason) {
      file_.fail(node, path(key),
                 "expected " + described(key) + ", got " + shown(node) + ": " + reason.what());
    }
    if (q.unit == Unit{} && key.measure.unit != Unit{}) {
      file_.fail(node, path(key),
                 "expected " + described(key) + ", got " + shown(node) +
                     ", which has no unit (a number without quotes is in " +
                     to_string(key.measure.unit) + ")");
    }
    if (q.unit != key.measure.unit) file_.expected(node, path(key), described(key));
    value = q.value;
  } else if (const auto* i = node.as_integer()) {
    value = static_cast<double>(i->get());
  } else if (const auto* f = node.as_floating_point()) {
    value = f->get();
  } else {
    file_.expected(node, path(key), described(key));
  }
  if (!accepts(key.range, value)) file_.expected(node, path(key), described(key));
  return value;
}

double TomlTable::number(const Key& key) { return quantity(require(key, described(key)), key); }

double TomlTable::number(const Key& key, double fallback) {
  const toml::node* node = find(key);
  return node != nullptr ? quantity(*node, key) : fallback;
}

const toml::array& TomlTable::list_of(const Key& key, const std::string& what) {
  const auto* array = require(key, "a list").as_array();
  if (array == nullptr || array->empty()) expected(key, what);
  return *array;
}

std::vector<double> TomlTable::numbers(const Key& key) {
  std::vector<double> values;
  for (const toml::node& item : list_of(key, "a list of numbers")) {
    values.push_back(quantity(item, key));
  }
  return values;
}

void TomlTable::read_vector(const toml::node& node, const Key& key, std::span<double> components) {
  const auto* array = node.as_array();
  if (array == nullptr || array->size() != components.size()) {
    file_.expected(node, path(key),
                   components_of(components.size()) + ", each " + std::string(key.measure.what) +
                       unit_of(key.measure));
  }
  for (std::size_t d = 0; d < components.size(); ++d) {
    components[d] = quantity(*array->get(d), key);
  }
}

std::int64_t TomlTable::integer(const Key& key, std::int64_t least, std::int64_t fallback) {
  const toml::node* node = find(key);
  if (node == nullptr) return fallback;
  const auto* value = node->as_integer();
  if (value == nullptr || value->get() < least) {
    expected(key, "a whole number, at least " + std::to_string(least));
  }
  return value->get();
}

bool TomlTable::flag(const Key& key, bool fallback) {
  const toml::node* node = find(key);
  if (node == nullptr) return fallback;
  if (!node->is_boolean()) expected(key, "true or false");
  return node->as_boolean()->get();
}

std::string TomlTable::text(const Key& key) {
  const toml::node& node = require(key, "text");
  if (!node.is_string()) expected(key, "text");
  if (key.name == keys::kName.name) expect_name(node, path(key), node.as_string()->get());
  return node.as_string()->get();
}

void TomlTable::expect_name(const toml::node& node, const std::string& path,
                            std::string_view name) const {
  constexpr std::size_t kLongest = 100;  // bytes: a name heads columns and stands in messages
  if (name.size() > kLongest) {
    file_.fail(node, path,
               "expected a name of at most " + std::to_string(kLongest) + " letters, got " +
                   std::to_string(name.size()));
  }
  if (readable(name) != name) {
    file_.fail(node, path,
               "expected a name without control characters, got " + lagrain::shown(name));
  }
}

std::vector<std::string> TomlTable::texts(const Key& key, const std::string& what,
                                          const char* each) {
  const auto* array = require(key, what).as_array();
  if (array == nullptr) expected(key, what);
  std::vector<std::string> list;
  for (const toml::node& item : *array) {
    if (!item.is_string()) file_.expected(item, path(key), each);
    list.push_back(item.as_string()->get());
  }
  return list;
}

std::size_t TomlTable::word(const Key& key, const std::vector<std::string_view>& words) {
  std::string all;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (k > 0) all += k + 1 == words.size() ? " or " : ", ";
    all += "\"" + std::string(words[k]) + "\"";
  }
  if (const auto* s = require(key, all).as_string()) {
    const auto found = std::find(words.begin(), words.end(), s->get());
    if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
    file_.fail(*find(key), path(key),
               "expected " + all + ", got " + lagrain::shown(s->get()) +
                   hint_for(s->get(), {words.begin(), words.end()}));
  }
  expected(key, all);
}

// -------------------------------------------------------------------------------------- tables

TomlTable TomlTable::table(const Key& key, const std::string& what) {
  const toml::node& node = require(key, what);
  if (!node.is_table()) expected(key, what);
  return {file_, *node.as_table(), path(key)};
}

std::size_t TomlTable::count_tables(const Key& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return 0;
  if (!node->is_array()) {
    fail(key, "expected tables headed [[" + std::string(key.name) + "]]");
  }
  return node->as_array()->size();
}

TomlTable TomlTable::table_at(const Key& key, std::size_t index) const {
  const toml::node& item = *table_.get(key.name)->as_array()->get(index);
  const std::string here = path(key) + "[" + std::to_string(index) + "]";
  if (!item.is_table()) file_.expected(item, here, "a table");
  file_.remember(here, item);
  return {file_, *item.as_table(), here};
}

}  // namespace lagrain::detail
