// SPDX-License-Identifier: GPL-3.0-or-later
#include "toml_table.hpp"

#include <lagrain/numbers.hpp>

#include <cmath>
#include <numeric>
#include <stdexcept>

namespace lagrain::detail {
namespace {

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

}  // namespace

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

void TomlFile::fail(const toml::node& node, const std::string& path,
                    const std::string& message) const {
  throw SceneError(name + ":" + std::to_string(node.source().begin.line) + ": " + path + ": " +
                   message);
}

void TomlFile::expected(const toml::node& node, const std::string& path,
                        const std::string& what) const {
  fail(node, path, "expected " + what + ", got " + shown(node));
}

toml::table parse_toml(std::string_view text, const std::string& name) {
  try {
    return toml::parse(text, std::string_view(name));
  } catch (const toml::parse_error& error) {
    std::string reason(error.description());
    if (!reason.empty() && reason.back() == '.') reason.pop_back();
    throw SceneError(name + ":" + std::to_string(error.source().begin.line) + ":" +
                     std::to_string(error.source().begin.column) + ": not valid TOML: " + reason);
  }
}

// ------------------------------------------------------------------------------- finding a key

const toml::node* TomlTable::find(const Key& key) {
  known_.emplace_back(key.name);
  const toml::node* node = table_.get(key.name);
  if (node != nullptr) (*file_.lines)[path(key)] = static_cast<int>(node->source().begin.line);
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
    if (edit_distance(other.str(), key.name) <= 2 &&
        std::find(known_.begin(), known_.end(), other.str()) == known_.end()) {
      hint = " (is \"" + std::string(other.str()) + "\" on line " +
             std::to_string(other.source().begin.line) + " meant?)";
    }
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
    throw SceneError(file_.name + ":" + std::to_string(key.source().begin.line) + ": " +
                     path(key.str()) + ": unknown key" + suggestion(key.str(), known_));
  }
}

std::vector<std::string> TomlTable::names() const {
  std::vector<std::pair<toml::source_position, std::string>> found;
  for (const auto& [key, node] : table_) found.emplace_back(key.source().begin, key.str());
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
  return node.as_string()->get();
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
  (*file_.lines)[here] = static_cast<int>(item.source().begin.line);
  return {file_, *item.as_table(), here};
}

}  // namespace lagrain::detail
