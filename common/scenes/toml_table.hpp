// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the scene reader: a table of a TOML file that knows where each of its keys stands,
/// what was asked for, and how to say what is wrong in one sentence.

#include "scene_keys.hpp"

#include <lagrain/check.hpp>
#include <lagrain/vec.hpp>

#define TOML_ENABLE_FORMATTERS 0
#include "toml_library.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lagrain::detail {

/// The file that is being read.
struct TomlFile {
  std::string name;
  std::map<std::string, int>* lines;  ///< path of a key -> its line

  /// Whether something stands in the file, and not in a setting beside it (settings.hpp).
  bool is_own(const toml::source_region& at) const { return !at.path || *at.path == name; }
  /// "file:line", or the setting.
  std::string place_of(const toml::source_region& at) const;
  /// Keeps the line of a key for messages that come later.
  void remember(const std::string& path, const toml::node& node) const;
  /// @throws SceneError "file:line: path: message"
  [[noreturn]] void fail(const toml::node& node, const std::string& path,
                         const std::string& message) const;
  /// @throws SceneError "file:line: path: expected <what>, got <what stands there>"
  [[noreturn]] void expected(const toml::node& node, const std::string& path,
                             const std::string& what) const;
};

/// Reads TOML text.
/// @throws SceneError with line and column
toml::table parse_toml(std::string_view text, const std::string& name);

/// One table of the file. It remembers which keys were asked for; `finish` refuses the others.
class TomlTable {
 public:
  TomlTable(const TomlFile& file, const toml::table& table, std::string path)
      : file_(file), table_(table), path_(std::move(path)) {}

  std::string path(const Key& key) const { return path(key.name); }

  /// Whether the key is there.
  bool has(const Key& key) { return find(key) != nullptr; }
  /// Whether the key is there and holds a table, a bare number, a text.
  bool holds_table(const Key& key) { return has(key) && find(key)->is_table(); }
  bool holds_number(const Key& key) { return has(key) && find(key)->is_number(); }
  bool holds_text(const Key& key) { return has(key) && find(key)->is_string(); }

  /// @throws SceneError at the key, or at the table if the key is not there
  [[noreturn]] void fail(const Key& key, const std::string& message);
  /// The same, telling what stands there.
  [[noreturn]] void expected(const Key& key, const std::string& what);
  /// The same for a key that is not there.
  [[noreturn]] void missing(const Key& key, const std::string& what);
  /// Fails if a known key is there that makes no sense here.
  void refuse(const Key& key, const std::string& why) {
    if (has(key)) fail(key, why);
  }

  double number(const Key& key);
  double number(const Key& key, double fallback);
  /// As many numbers as there are.
  std::vector<double> numbers(const Key& key);
  template <int N>
  Eigen::Matrix<double, N, 1> vector(const Key& key) {
    const toml::node& node = require(key, components_of(N));
    Eigen::Matrix<double, N, 1> v;
    read_vector(node, key, {v.data(), static_cast<std::size_t>(N)});
    return v;
  }
  /// As many vectors as there are.
  template <int N>
  std::vector<Eigen::Matrix<double, N, 1>> vectors(const Key& key) {
    std::vector<Eigen::Matrix<double, N, 1>> list;
    for (const toml::node& item : list_of(key, "a list of points")) {
      read_vector(item, key, {list.emplace_back().data(), static_cast<std::size_t>(N)});
    }
    return list;
  }
  /// Lists of as many vectors as there are.
  template <int N>
  std::vector<std::vector<Eigen::Matrix<double, N, 1>>> vector_lists(const Key& key) {
    std::vector<std::vector<Eigen::Matrix<double, N, 1>>> lists;
    for (const toml::node& item : list_of(key, "a list of lists of points")) {
      const toml::array* points = item.as_array();
      if (points == nullptr || points->empty()) file_.expected(item, path(key), "a list of points");
      auto& list = lists.emplace_back();
      for (const toml::node& point : *points) {
        read_vector(point, key, {list.emplace_back().data(), static_cast<std::size_t>(N)});
      }
    }
    return lists;
  }
  std::int64_t integer(const Key& key, std::int64_t least, std::int64_t fallback);
  bool flag(const Key& key, bool fallback);
  std::string text(const Key& key);
  std::string text(const Key& key, const std::string& fallback) {
    return has(key) ? text(key) : fallback;
  }
  /// Texts of a list.
  std::vector<std::string> texts(const Key& key, const std::string& what, const char* each);
  /// The place of the key's text in a list of words.
  std::size_t word(const Key& key, const std::vector<std::string_view>& words);
  template <class E, std::size_t N>
  E word(const Key& key, const std::array<Word<E>, N>& words, std::optional<E> fallback = {}) {
    if (fallback && !has(key)) return *fallback;
    std::vector<std::string_view> texts;
    for (const Word<E>& w : words) texts.push_back(w.text);
    return words[word(key, texts)].value;
  }

  /// A table that is a key of this one.
  /// @param what  it should be, for the message
  TomlTable table(const Key& key, const std::string& what = "a table");
  /// Visits each table of [[key]]: f(table, index).
  template <class F>
  void for_each(const Key& key, F&& f) {
    for (std::size_t k = 0; k < count_tables(key); ++k) {
      TomlTable item = table_at(key, k);
      f(item, static_cast<int>(k));
      item.finish();
    }
  }
  /// The names of all keys, in the order of the file.
  std::vector<std::string> names() const;

  /// @throws SceneError if there is a key that nobody asked for
  void finish() const;

 private:
  std::string path(std::string_view name) const {
    return path_.empty() ? std::string(name) : path_ + "." + std::string(name);
  }
  /// How so many components are written.
  static std::string components_of(std::size_t count) {
    return count == 1 ? "[x]" : count == 2 ? "[x, y]" : "[x, y, z]";
  }
  /// @throws SceneError if it would harm what it heads or a message that it stands in
  void expect_name(const toml::node& node, const std::string& path, std::string_view name) const;
  const toml::node* find(const Key& key);
  const toml::node& require(const Key& key, const std::string& what);
  double quantity(const toml::node& node, const Key& key) const;
  /// @throws SceneError if there is no list with something in it
  const toml::array& list_of(const Key& key, const std::string& what);
  void read_vector(const toml::node& node, const Key& key, std::span<double> components);
  std::size_t count_tables(const Key& key);
  TomlTable table_at(const Key& key, std::size_t index) const;

  const TomlFile& file_;
  const toml::table& table_;
  std::string path_;
  std::vector<std::string> known_;
};

}  // namespace lagrain::detail
