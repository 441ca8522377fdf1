// SPDX-License-Identifier: GPL-3.0-or-later
#include "mathml.hpp"

#include <lagrain/check.hpp>

#include <cctype>
#include <cstddef>
#include <vector>

namespace lagrain::figures {
namespace {

std::string element(const std::string& tag, const std::string& inside) {
  return "<" + tag + ">" + inside + "</" + tag + ">";
}

/// Reads a formula from left to right.
class Formula {
 public:
  explicit Formula(std::string_view text) : text_(text) {}

  std::string whole() {
    std::string inside = row('\0');
    if (at_ < text_.size()) fail("a brace too many");
    return inside;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw SceneError("formula \"" + std::string(text_) + "\": " + what);
  }
  bool ended() const { return at_ >= text_.size(); }
  void skip_blanks() {
    while (!ended() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }

  /// What stands before `end`, in a row.
  std::string row(char end) {
    std::vector<std::string> parts;
    for (skip_blanks(); !ended() && text_[at_] != end && text_[at_] != '}'; skip_blanks()) {
      const char c = text_[at_];
      if (c != '^' && c != '_') {
        parts.push_back(atom());
        continue;
      }
      if (parts.empty()) fail("nothing in front of ^ or _");
      ++at_;
      const std::string tag = c == '^' ? "msup" : "msub";
      parts.back() = element(tag, parts.back() + atom());
    }
    std::string inside;
    for (const std::string& part : parts) inside += part;
    return element("mrow", inside);
  }

  std::string group() {
    skip_blanks();
    if (ended() || text_[at_] != '{') fail("expected {");
    ++at_;
    std::string inside = row('}');
    if (ended()) fail("a { without }");
    ++at_;
    return inside;
  }

  std::string atom() {
    skip_blanks();
    if (ended()) fail("it ends too early");
    const char c = text_[at_];
    if (c == '{') return group();
    if (c == '\\') return command();
    if (std::isdigit(static_cast<unsigned char>(c))) {
      const std::size_t begin = at_;
      while (!ended() && (std::isdigit(static_cast<unsigned char>(text_[at_])) ||
                          (text_[at_] == '.' && at_ + 1 < text_.size() &&
                           std::isdigit(static_cast<unsigned char>(text_[at_ + 1]))))) {
        ++at_;
      }
      return element("mn", std::string(text_.substr(begin, at_ - begin)));
    }
    if (std::isalpha(static_cast<unsigned char>(c))) {
      const std::size_t begin = at_;
      while (!ended() && std::isalpha(static_cast<unsigned char>(text_[at_]))) ++at_;
      const std::string_view word = text_.substr(begin, at_ - begin);
      if (word == "max") return element("mi", "max");
      // Letters beside each other are a product: one at a time.
      at_ = begin + 1;
      return element("mi", std::string(1, c));
    }
    ++at_;
    switch (c) {
      case '-':
        return element("mo", "\xE2\x88\x92");
      case '<':
        return element("mo", "&lt;");
      case '>':
        return element("mo", "&gt;");
      case '|':
        return "<mo stretchy=\"false\">|</mo>";
      case '(':
      case ')':
        return "<mo stretchy=\"false\">" + std::string(1, c) + "</mo>";
      case ',':
      case '+':
      case '=':
      case '/':
        return element("mo", std::string(1, c));
      default:
        fail("unknown sign '" + std::string(1, c) + "'");
    }
  }

  std::string command() {
    const std::size_t begin = ++at_;
    while (!ended() && std::isalpha(static_cast<unsigned char>(text_[at_]))) ++at_;
    const std::string_view name = text_.substr(begin, at_ - begin);
    if (name == "pi") return element("mi", "\xCF\x80");
    if (name == "cdot") return element("mo", "\xC2\xB7");
    if (name == "sqrt") return element("msqrt", group());
    if (name == "frac") {
      const std::string above = group();
      return element("mfrac", above + group());
    }
    fail("unknown name \\" + std::string(name));
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::string mathml(std::string_view formula, bool block) {
  return (block ? "<math display=\"block\">" : "<math>") + Formula(formula).whole() + "</math>";
}

std::string with_formulas(const std::string& text) {
  std::string out;
  std::size_t at = 0;
  for (std::size_t dollar; (dollar = text.find('$', at)) != std::string::npos;) {
    out += text.substr(at, dollar - at);
    const bool block = text.compare(dollar, 2, "$$") == 0;
    const std::string mark = block ? "$$" : "$";
    const std::size_t begin = dollar + mark.size(), end = text.find(mark, begin);
    if (end == std::string::npos) {
      throw SceneError("a formula does not end: \"" + text.substr(dollar, 40) + "\"");
    }
    out += mathml(std::string_view(text).substr(begin, end - begin), block);
    at = end + mark.size();
  }
  return out + text.substr(at);
}

}  // namespace lagrain::figures
