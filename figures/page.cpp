// SPDX-License-Identifier: GPL-3.0-or-later
#include "page.hpp"

#include <string_view>

namespace lagrain {

namespace {

namespace fs = std::filesystem;

constexpr const char* kBeforeTitle = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>)";

constexpr const char* kAfterTitle = R"(</title>
<style>
body { font: 17px/1.55 "Latin Modern Roman", Charter, Georgia, serif; color: #222; background: #fff;
       max-width: 52rem; margin: 3rem auto; padding: 0 1.2rem; }
h1 { font-weight: normal; margin-bottom: 0; }
h2 { font-size: 1.25rem; margin: 0 0 .8rem; }
article { border-top: 1px solid #ccc; padding-top: 1.6rem; margin-top: 2.6rem; }
img, video { display: block; max-width: 100%; height: auto; margin: .6rem 0; }
table { border-collapse: collapse; margin: .8rem 0; font-size: .92rem; }
th, td { text-align: left; vertical-align: top; padding: .15rem 1.4rem .15rem 0; }
th { font-weight: normal; color: #666; }
caption { text-align: left; font-style: italic; }
thead th { border-bottom: 1px solid #ccc; }
.links, .note { color: #666; font-size: .92rem; }
.links a { margin-right: 1rem; }
a { color: #0a5a9c; }
</style>
</head>
<body>
)";

}  // namespace

std::string page_head(const std::string& title) {
  return kBeforeTitle + escaped(title) + kAfterTitle;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string page_link(const fs::path& file, const fs::path& out) {
  const std::string plain =
      (file.is_absolute() ? file.lexically_relative(fs::absolute(out)) : file).generic_string();
  std::string url;
  for (const char c : plain) {
    constexpr std::string_view kHex = "0123456789ABCDEF";
    if (std::string_view("%?#\"<> &").find(c) == std::string_view::npos) {
      url += c;
    } else {
      url += '%';
      url += kHex[static_cast<unsigned char>(c) / 16];
      url += kHex[static_cast<unsigned char>(c) % 16];
    }
  }
  return url;
}

}  // namespace lagrain
