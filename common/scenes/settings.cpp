// SPDX-License-Identifier: GPL-3.0-or-later
#include "settings.hpp"

#include <lagrain/words.hpp>

#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

namespace lagrain::detail {
namespace {

/// A step on the way to a key: a name in a table, or which one of a list.
struct Step {
  std::string text;
  bool in_list = false;
  bool quoted = false;  // a name, even if it is a number
};

/// The number of an item, if the step gives one.
std::optional<std::size_t> number_in(const Step& step) {
  std::size_t number = 0;
  const char* const end = step.text.data() + step.text.size();
  const auto [stop, failure] = std::from_chars(step.text.data(), end, number);
  if (step.quoted || failure != std::errc{} || stop != end) return {};
  return number;
}

class SettingApplier {
 public:
  explicit SettingApplier(const std::string& setting)
      : place_("--set " + shortened(setting)), left_(setting) {}

  void apply(toml::table& root) {
    const std::vector<Step> steps = read_steps();
    toml::table holder = value_of(left_);
    toml::node* at = &root;
    for (const Step& step : steps) {
      const bool last = &step == &steps.back();
      at = step.in_list ? item_of(*at, step) : key_of(*at, step, last);
      walked_ += step.in_list ? "[" + shortened(step.text) + "]"
                              : (walked_.empty() ? "" : ".") + shortened(step.text);
      if (!last) continue;
      if (step.in_list) {
        put(*parent_->as_array(), number_, std::move(*holder.get(kValue)));
      } else {
        parent_->as_table()->insert_or_assign(step.text, std::move(*holder.get(kValue)));
      }
    }
  }

 private:
  static constexpr const char* kValue = "value";

  [[noreturn]] void fail(const std::string& message) const {
    throw SceneError(place_ + ": " + message);
  }
  [[noreturn]] void fail_form() const {
    fail("expected a key, \"=\" and a value, such as law.friction=0.3");
  }

  /// Reads what stands before "=", and leaves what stands behind it.
  std::vector<Step> read_steps() {
    std::vector<Step> steps;
    for (;;) {
      Step step;
      if (!left_.empty() && left_.front() == '"') {
        step.text = quoted();
      } else {
        const std::size_t end = std::min(left_.find_first_of(".[= \""), left_.size());
        step.text = left_.substr(0, end);
        left_.remove_prefix(end);
      }
      if (step.text.empty()) fail_form();
      steps.push_back(std::move(step));
      while (!left_.empty() && left_.front() == '[') steps.push_back(bracket());
      skip_blanks();
      if (left_.empty()) fail_form();
      const char next = left_.front();
      left_.remove_prefix(1);
      if (next == '=') return steps;
      if (next != '.') fail_form();
    }
  }
  Step bracket() {
    left_.remove_prefix(1);
    Step step;
    step.in_list = true;
    if (!left_.empty() && left_.front() == '"') {
      step.quoted = true;
      step.text = quoted();
    } else {
      const std::size_t end = std::min(left_.find(']'), left_.size());
      step.text = left_.substr(0, end);
      left_.remove_prefix(end);
    }
    if (left_.empty() || left_.front() != ']' || step.text.empty()) fail_form();
    left_.remove_prefix(1);
    return step;
  }
  std::string quoted() {
    const std::size_t end = left_.find('"', 1);
    if (end == std::string_view::npos) fail_form();
    std::string text(left_.substr(1, end - 1));
    left_.remove_prefix(end + 1);
    return text;
  }
  void skip_blanks() {
    while (!left_.empty() && left_.front() == ' ') left_.remove_prefix(1);
  }

  /// A table that holds the value alone. What is no TOML is a number in another spelling (".5"), or
  /// text whose quotes were left out: a word, or a number with its unit.
  toml::table value_of(std::string_view text) {
    skip_blanks();
    text = left_;
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    if (text.empty()) fail_form();
    const std::string key = std::string(kValue) + " = ";
    std::string why;
    if (text.find('\n') == std::string_view::npos) {
      try {
        return parse_toml(key + std::string(text), place_);
      } catch (const SceneError& error) {
        const std::string_view message = error.what();
        constexpr std::string_view kReason = "not valid TOML: ";
        why = message.substr(std::min(message.rfind(kReason), message.size()));
      }
    }
    if (std::string_view("[{\"'").find(text.front()) != std::string_view::npos) fail(why);
    toml::table holder = parse_toml(key + "\"\"", place_);
    double number = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, failure] = std::from_chars(text.data(), end, number);
    if (failure == std::errc{} && stop == end) {
      holder = parse_toml(key + "0.0", place_);
      holder.get(kValue)->as_floating_point()->get() = number;
    } else {
      holder.get(kValue)->as_string()->get() = text;
    }
    return holder;
  }

  /// The table that a key stands in. A list of one table stands for it.
  toml::table& table_in(toml::node& node) const {
    if (node.is_table()) return *node.as_table();
    toml::array* const list = node.as_array();
    if (list == nullptr || list->empty() || !list->front().is_table()) {
      fail(walked_ + " holds a value and no table");
    }
    if (list->size() > 1) {
      fail("there are " + std::to_string(list->size()) + " [[" + walked_ +
           "]]; say which: " + walked_ + "[0], or " + walked_ + "[NAME]");
    }
    return *list->front().as_table();
  }

  toml::node* key_of(toml::node& node, const Step& step, bool last) {
    toml::table& table = table_in(node);
    parent_ = &table;
    if (last) return &table;
    if (toml::node* const there = table.get(step.text)) return there;
    toml::table empty = parse_toml(std::string(kValue) + " = {}", place_);
    table.insert_or_assign(step.text, std::move(*empty.get(kValue)));
    return table.get(step.text);
  }

  toml::node* item_of(toml::node& node, const Step& step) {
    toml::array* const list = node.as_array();
    if (list == nullptr) fail(walked_ + " is no list");
    parent_ = list;
    std::vector<std::string> names;
    const auto number = number_in(step);
    for (std::size_t k = 0; k < list->size(); ++k) {
      toml::node& item = *list->get(k);
      const toml::node* const name =
          item.is_table() ? item.as_table()->get(keys::kName.name) : nullptr;
      if (name != nullptr && name->is_string()) names.push_back(name->as_string()->get());
      const bool called = name != nullptr && name->is_string() && names.back() == step.text;
      if (number ? *number != k : !called) continue;
      number_ = k;
      return &item;
    }
    if (number) {
      fail("there is no " + walked_ + "[" + step.text + "]: the list has " +
           std::to_string(list->size()) + ", counted from 0");
    }
    fail("there is no " + walked_ + " with name = " + shown(step.text) +
         suggestion(step.text, names));
  }

  static void put(toml::array& list, std::size_t number, toml::node&& value) {
    list.replace(list.cbegin() + static_cast<std::ptrdiff_t>(number), std::move(value));
  }

  std::string place_;
  std::string_view left_;  // to be read
  std::string walked_;     // the path so far
  toml::node* parent_ = nullptr;
  std::size_t number_ = 0;  // in the last list
};

}  // namespace

void apply_setting(toml::table& root, const std::string& setting) {
  SettingApplier(setting).apply(root);
}

}  // namespace lagrain::detail
