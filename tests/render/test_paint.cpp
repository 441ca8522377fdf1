// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/paint.hpp>

#include "paint_cairo.hpp"
#include "support.hpp"

#include <lagrain/check.hpp>
#include <lagrain/plot.hpp>
#include <lagrain/random.hpp>

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstdlib>
#include <numbers>
#include <string>
#include <thread>

using namespace lagrain;
using lagrain::test::content;
using lagrain::test::ink;
using lagrain::test::MadeFolder;
using lagrain::test::mixed_list;
using lagrain::test::pixel;
using lagrain::test::psnr;
using lagrain::test::relative_error;

// Mesa itself loses some bytes once when it starts; leaks of ours are still reported.
extern "C" const char* __lsan_default_suppressions() {  // NOLINT: the sanitizer gives the name
  return "leak:libOSMesa\nleak:libEGL_mesa\nleak:libgallium\nleak:swrast_dri";
}

namespace {

// Mesa keeps compiled shaders in the home folder; a test writes nowhere but to its own folder.
[[maybe_unused]] const int kNoShaderCache = setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);

constexpr Colour kBlack{0, 0, 0, 255};

DisplayList page(double size) { return {size, size}; }

// Ink of one item on a page of 64 pt at 72 dots per inch: one pixel is one point.
double ink_of(const Item& item, Quality quality = Quality::still) {
  DisplayList list = page(64);
  list.add(item);
  return ink(paint_rgba(list, 72, quality));
}

}  // namespace

TEST_SUITE("paint") {
  TEST_CASE("a disc covers pi r^2, with and without an outline, wherever it lies") {
    for (const double r : {2.0, 7.3, 20.0}) {
      for (const double shift : {0.0, 0.13, 0.5}) {
        const Vec<2> centre(32 + shift, 32 - 0.7 * shift);
        const double area = std::numbers::pi * r * r;
        // 8 bits a channel round the edge's pixels; the smallest disc has few of them.
        const double tolerance = r < 5 ? 5e-3 : 1e-3;

        CHECK(relative_error(ink_of(Disc{centre, r, kBlack, {}}), area) < tolerance);
        CHECK(relative_error(ink_of(Disc{centre, r, kBlack, {kBlack, 1}}), area) < tolerance);
      }
    }
  }

  TEST_CASE("discs far smaller than a pixel keep their area on average") {
    for (const double r : {0.05, 0.1, 0.25, 0.4, 0.7}) {
      DisplayList list = page(200);
      list.background = {255, 255, 255, 255};
      Random random(3);
      for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 40; ++x) {
          list.add(Disc{
              {5 * x + 1 + 2 * random.uniform(), 5 * y + 1 + 2 * random.uniform()}, r, kBlack, {}});
        }
      }
      // Two decimals: a coverage below half of 1/255 is lost in each sample.
      CHECK(relative_error(ink(paint_rgba(list, 72)), 1600 * std::numbers::pi * r * r) <
            (r < 0.2 ? 0.08 : 0.02));
    }
  }

  TEST_CASE("a segment covers its length times its width and two half discs") {
    for (const double width : {1.0, 3.0, 9.0}) {
      for (const double angle : {0.0, 0.3, std::numbers::pi / 4, 1.2}) {
        const Vec<2> half = 18 * Vec<2>(std::cos(angle), std::sin(angle)), middle(32.2, 31.7);
        const double area = 36 * width + std::numbers::pi * width * width / 4;

        CHECK(relative_error(ink_of(Segment{middle - half, middle + half, {kBlack, width}}), area) <
              4e-3);
      }
    }
  }

  TEST_CASE("a line thinner than a pixel becomes fainter in proportion") {
    for (const double width : {0.05, 0.1, 0.25, 0.5}) {
      for (const double angle : {0.0, 0.5}) {
        const Vec<2> half = 20 * Vec<2>(std::cos(angle), std::sin(angle)), middle(32.25, 32.25);
        const Segment line{middle - half, middle + half, {kBlack, width}};

        // A pixel's coverage, about the width, is rounded to 1/255; the ends err by a little more.
        const double tolerance = 0.5 / (255 * width) + 0.02;
        CHECK(relative_error(ink_of(line), 40 * width) < tolerance);
        CHECK(relative_error(ink_of(line, Quality::frame), 40 * width) < tolerance);
      }
    }
  }

  TEST_CASE("a polygon covers its area in either sense of rotation") {
    const std::vector<Vec<2>> shape{{10.3, 12.1}, {50.2, 15.7}, {44.9, 40.3}, {20.6, 50.2}};
    const std::vector<Vec<2>> reversed(shape.rbegin(), shape.rend());
    double area = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec<2>&a = shape[k], &b = shape[(k + 1) % 4];
      area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    }

    CHECK(relative_error(ink_of(Polygon{shape, kBlack, {}}), area) < 1e-3);
    CHECK(relative_error(ink_of(Polygon{reversed, kBlack, {}}), area) < 1e-3);
    CHECK(ink_of(Polygon{corners({{10, 10}, {30, 20}}), kBlack, {}}) == 200);
  }

  TEST_CASE("nothing leaves a clip, and clips within clips intersect") {
    DisplayList list = page(64);
    list.add(PushClip{{{10, 10}, {50, 50}}});
    list.add(PushClip{{{20, 0}, {60, 40}}});
    list.add(Disc{{32, 32}, 100, kBlack, {}});
    list.add(PopClip{});
    list.add(PopClip{});

    CHECK(ink(paint_rgba(list, 72)) == 900);
    CHECK(pixel(paint_rgba(list, 72), 20, 63 - 10, 0) == 0);
    CHECK(pixel(paint_rgba(list, 72), 19, 63 - 10, 0) == 255);
    CHECK(psnr(paint_rgba(list, 72), detail::paint_rgba_cairo(list, 72)) > 100);
  }

  TEST_CASE("clips that do not match are refused by every painter") {
    DisplayList open = page(10), shut = page(10);
    open.add(PushClip{open.page()});
    shut.add(PopClip{});

    for (const DisplayList& list : {open, shut}) {
      CHECK_THROWS_AS(paint_rgba(list, 72), ContractError);
      CHECK_THROWS_AS(detail::encode_pdf(list), ContractError);
    }
    CHECK(ink(paint_rgba(page(10), 72)) == 0);  // the painter is as good as before
  }

  TEST_CASE("later items lie on top, in short and in long runs of one kind") {
    for (const int many : {1, 300}) {
      DisplayList list = page(64);
      for (int k = 0; k < many; ++k) list.add(Disc{{32, 32}, 20, {255, 0, 0, 255}, {}});
      for (int k = 0; k < many; ++k) list.add(Segment{{0, 32}, {64, 32}, {{0, 255, 0, 255}, 8}});
      list.add(Polygon{corners({{30, 30}, {34, 34}}), {0, 0, 255, 255}, {}});
      list.add(Disc{{32, 50}, 2, {9, 9, 9, 255}, {}});

      const Image image = paint_rgba(list, 72);

      CHECK(pixel(image, 32, 20, 0) == 255);
      CHECK(pixel(image, 25, 32, 1) == 255);
      CHECK(pixel(image, 32, 32, 2) == 255);
      CHECK(pixel(image, 32, 13, 0) == 9);
    }
  }

  TEST_CASE("an image keeps its pixels when each of them is a pixel of the page") {
    Image image{16, 8, {}};
    Random random(11);
    for (int k = 0; k < 16 * 8; ++k) {
      for (int c = 0; c < 3; ++c)
        image.rgba.push_back(static_cast<std::uint8_t>(random.below(256)));
      image.rgba.push_back(255);
    }
    DisplayList list{16, 8};
    list.add(Picture{image, list.page()});

    CHECK((paint_rgba(list, 72).rgba == image.rgba));
    CHECK((paint_rgba(list, 72, Quality::frame).rgba == image.rgba));
    CHECK((detail::paint_rgba_cairo(list, 72).rgba == image.rgba));
  }

  TEST_CASE("a transparent page keeps straight alpha") {
    DisplayList list = page(20);
    list.background = {0, 0, 0, 0};
    list.add(Disc{{10, 10}, 8, {200, 100, 50, 128}, {}});

    for (const Image& image : {paint_rgba(list, 72), detail::paint_rgba_cairo(list, 72)}) {
      CHECK(pixel(image, 0, 0, 3) == 0);
      CHECK(pixel(image, 10, 10, 3) == 128);
      CHECK(std::abs(pixel(image, 10, 10, 0) - 200) <= 2);
      CHECK(std::abs(pixel(image, 10, 10, 2) - 50) <= 2);
    }
  }

  TEST_CASE("OpenGL and Cairo paint the same picture") {
    const DisplayList list = mixed_list();
    for (const double dpi : {150.0, 300.0}) {
      const Image ours = paint_rgba(list, dpi), witness = detail::paint_rgba_cairo(list, dpi);

      REQUIRE(ours.width == witness.width);
      REQUIRE(ours.height == witness.height);
      const double agreement = psnr(ours, witness);
      MESSAGE("agreement at " << dpi << " dpi: " << agreement << " dB");
      CHECK(agreement >= 35);
    }
  }

  TEST_CASE("the same list gives the same bytes, on any thread") {
    const DisplayList list = mixed_list();
    const Image first = paint_rgba(list, 100);
    Image other;

    std::thread([&] { other = paint_rgba(list, 100); }).join();

    CHECK((first.rgba == paint_rgba(list, 100).rgba));
    CHECK((first.rgba == other.rgba));
  }

  TEST_CASE("the same list gives the same files") {
    const DisplayList list = mixed_list();
    const MadeFolder folder;
    for (const std::string name : {"a", "b"}) {
      paint_png(list, folder.path / (name + ".png"), 100);
      paint_pdf(list, folder.path / (name + ".pdf"));
      paint_svg(list, folder.path / (name + ".svg"));
    }
    for (const std::string ending : {".png", ".pdf", ".svg"}) {
      CHECK(content(folder.path / ("a" + ending)).size() > 5000);
      const bool equal =
          content(folder.path / ("a" + ending)) == content(folder.path / ("b" + ending));
      CHECK_MESSAGE(equal, ending);
    }
    CHECK(std::distance(std::filesystem::directory_iterator(folder.path), {}) == 6);
  }

  TEST_CASE("a PDF embeds its fonts") {
    const std::string pdf = detail::encode_pdf(mixed_list());
    const auto count = [&pdf](const std::string& word) {
      int n = 0;
      for (auto at = pdf.find(word); at != std::string::npos; at = pdf.find(word, at + 1)) ++n;
      return n;
    };

    CHECK(count("/FontFile") >= 2);
    CHECK(count("/FontFile") == count("/FontDescriptor\n"));
    CHECK(count("LMRoman10") > 0);
    CHECK(count("LatinModernMath") > 0);
  }

  TEST_CASE("a PNG knows its resolution") {
    const MadeFolder folder;
    paint_png(page(72), folder.path / "a.png", 300);
    const std::string png = content(folder.path / "a.png");
    const auto at = png.find("pHYs");

    REQUIRE(at != std::string::npos);
    CHECK(png.substr(at + 4, 9) ==
          std::string("\0\0\x2e\x23\0\0\x2e\x23\1", 9));  // 11811 per metre
  }

  TEST_CASE("a file that cannot be written is named, and nothing is left behind") {
    const MadeFolder folder;
    std::filesystem::create_directory(folder.path / "taken.png");
    const DisplayList list = page(20);
    for (const auto& path : {folder.path / "missing" / "a.png", folder.path / "taken.png"}) {
      CHECK_THROWS_WITH_AS(paint_png(list, path, 72), doctest::Contains(path.string().c_str()),
                           SceneError);
      CHECK_THROWS_WITH_AS(paint_pdf(list, path), doctest::Contains(path.string().c_str()),
                           SceneError);
      CHECK_THROWS_WITH_AS(paint_svg(list, path), doctest::Contains(path.string().c_str()),
                           SceneError);
    }
    CHECK(std::distance(std::filesystem::directory_iterator(folder.path), {}) == 1);
  }

  TEST_CASE("pages without size and pictures too large are refused with their numbers") {
    CHECK_THROWS_AS(paint_rgba(DisplayList{0, 10}, 72), ContractError);
    CHECK_THROWS_AS(paint_rgba(DisplayList{10, 10}, 0), ContractError);
    CHECK_THROWS_WITH_AS(paint_rgba(DisplayList{72, 72}, 9000), doctest::Contains("9000 x 9000"),
                         SceneError);
    CHECK_THROWS_AS(write_png(Image{3, 3, {}}, "never.png"), ContractError);
  }

  TEST_CASE("things without size are not drawn") {
    CHECK(ink_of(Disc{{32, 32}, 0, kBlack, {kBlack, 1}}) == 0);
    CHECK(ink_of(Segment{{1, 1}, {60, 60}, {kBlack, 0}}) == 0);
    CHECK(ink_of(Label{"", {32, 32}}) == 0);
    CHECK_THROWS_AS(ink_of(Polygon{{{1, 1}, {2, 2}}, kBlack, {}}), ContractError);
  }
}
