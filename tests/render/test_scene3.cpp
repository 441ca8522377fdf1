// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/scene3.hpp>

#include "paint3_gl.hpp"
#include "paint_cairo.hpp"
#include "support.hpp"

#include <lagrain/check.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/random.hpp>

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

using namespace lagrain;
using lagrain::test::heap;
using lagrain::test::ink;
using lagrain::test::pixel;
using lagrain::test::relative_error;

namespace {

constexpr Colour kRed{220, 30, 20, 255}, kGreen{20, 180, 60, 255}, kBlack{0, 0, 0, 255};
constexpr double kNothing = std::numeric_limits<double>::infinity();

// Looks along +y at the origin; the picture is `height` metres high and the eye 5 m away.
Scene3 scene(double height, bool perspective = false) {
  Scene3 one;
  one.camera = {{0, -5, 0}, {0, 0, 0}, {0, 0, 1}, height, perspective};
  one.lights = over_the_shoulder(one.camera);
  one.outline.width = 0;
  one.subframes = 1;
  return one;
}

// A ball of radius 1 m at the origin, seen on 101 x 101 pixels.
Scene3 one_ball(bool perspective = false) {
  Scene3 one = scene(4, perspective);
  one.balls.push_back({{0, 0, 0}, 1, kRed});
  return one;
}

// Pixels that the bodies cover, by the alpha of a picture without background.
double covered(Scene3 one, int size) {
  one.background.a = 0;
  const Image image = paint_scene3(one, size, size);
  double sum = 0;
  for (std::size_t k = 3; k < image.rgba.size(); k += 4) sum += image.rgba[k];
  return sum / 255;
}

int brightness(const Image& image, int x, int y) {
  return pixel(image, x, y, 0) + pixel(image, x, y, 1) + pixel(image, x, y, 2);
}

// Middle pixel of an odd number of rows and columns.
double middle(const std::vector<double>& depths) { return depths[depths.size() / 2]; }

// Column and row of a picture in which a point of the scene is seen.
struct Pixel {
  int x, y;
};
Pixel seen_at(const Scene3& one, const Vec<3>& world, int width, int height) {
  const Vec<2> p = View3(one.camera, {{0, 0}, {width, height}}).point(world);
  return {static_cast<int>(p[0]), height - 1 - static_cast<int>(p[1])};
}

}  // namespace

TEST_SUITE("scene3") {
  TEST_CASE("the nearest point of a ball has its exact depth") {
    for (const bool perspective : {false, true}) {
      Scene3 one = one_ball(perspective);
      CHECK(relative_error(middle(detail::depths(one, 101, 101)), 4) < 1e-6);

      // Far smaller than the scene, and far from the origin.
      const Vec<3> far(1e4, 2e4, -3e4);
      one.balls[0] = {far, 0.01, kRed};
      one.balls.push_back({far + Vec<3>(3, 3, 1), 0.01, kRed});
      one.camera.eye += far;
      one.camera.target += far;
      CHECK(relative_error(middle(detail::depths(one, 101, 101)), 4.99) < 1e-6);
    }
  }

  TEST_CASE("a ball has the depth of a sphere all over") {
    for (const bool perspective : {false, true}) {
      const Scene3 one = one_ball(perspective);
      const std::vector<double> depths = detail::depths(one, 101, 101);
      for (std::size_t y = 0; y < 101; ++y) {
        for (std::size_t x = 0; x < 101; ++x) {
          // The line of sight through the pixel's middle: at + t along, t the depth.
          const Vec<3> q(4 * (static_cast<double>(x) + 0.5) / 101 - 2, 0,
                         2 - 4 * (static_cast<double>(y) + 0.5) / 101);
          const Vec<3> eye(0, -5, 0), ahead(0, 1, 0);
          const Vec<3> at = perspective ? eye : Vec<3>(eye + q),
                       along = perspective ? Vec<3>(ahead + q / 5) : ahead;
          const double a = along.squaredNorm(), b = at.dot(along), c = at.squaredNorm() - 1;
          const double root = b * b - a * c;
          if (std::abs(root) < 1e-3) continue;  // at the rim
          const double depth = depths[101 * y + x];

          CHECK((depth < kNothing) == (root > 0));
          if (root > 0) CHECK(std::abs(depth - (-b - std::sqrt(root)) / a) < 1e-5);
        }
      }
    }
  }

  TEST_CASE("a ball covers pi r^2 of the picture, in perspective that of its outline") {
    Scene3 one = one_ball();
    one.subframes = kPrintSubframes;
    CHECK(relative_error(covered(one, 401), std::numbers::pi * 401 * 401 / 16) < 2e-3);

    // From the distance D the outline of a ball has the slope r / sqrt(D^2 - r^2).
    one.camera.perspective = true;
    CHECK(relative_error(covered(one, 401), std::numbers::pi * 401 * 401 / 16 * 25 / 24) < 2e-3);
  }

  TEST_CASE("balls hidden behind a nearer one change nothing") {
    for (const bool perspective : {false, true}) {
      const Scene3 one = one_ball(perspective);
      Scene3 more = one;
      Random random(3);
      for (int k = 0; k < 500; ++k) {
        const Vec<3> at(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6),
                        random.uniform(-0.6, 0.6));
        more.balls.push_back({at * std::min(1.0, 0.9 / at.norm()), 0.05, kGreen});
      }

      CHECK((paint_scene3(one, 200, 200).rgba == paint_scene3(more, 200, 200).rgba));
    }
  }

  TEST_CASE("every ball of a packing that can be seen is seen") {
    // Distance to the nearest of many balls along each line of sight, by trying all.
    for (const bool perspective : {false, true}) {
      Scene3 one = scene(2.4, perspective);
      Random random(8);
      for (int k = 0; k < 400; ++k) {
        one.balls.push_back({{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)},
                             random.uniform(0.02, 0.25),
                             kRed});
      }
      const std::vector<double> depths = detail::depths(one, 120, 120);
      int wrong = 0;
      for (std::size_t y = 0; y < 120; ++y) {
        for (std::size_t x = 0; x < 120; ++x) {
          const Vec<3> q(2.4 * (static_cast<double>(x) + 0.5) / 120 - 1.2, 0,
                         1.2 - 2.4 * (static_cast<double>(y) + 0.5) / 120);
          const Vec<3> eye(0, -5, 0), ahead(0, 1, 0);
          const Vec<3> at = perspective ? eye : Vec<3>(eye + q),
                       along = perspective ? Vec<3>(ahead + q / 5) : ahead;
          double nearest = kNothing;
          bool rim = false;
          for (const Ball& ball : one.balls) {
            const Vec<3> m = at - ball.centre;
            const double a = along.squaredNorm(), b = m.dot(along);
            const double root = b * b - a * (m.squaredNorm() - ball.radius * ball.radius);
            rim = rim || std::abs(root) < 1e-5;
            if (root > 0) nearest = std::min(nearest, (-b - std::sqrt(root)) / a);
          }
          const double depth = depths[120 * y + x];
          const bool same =
              nearest < kNothing ? std::abs(depth - nearest) < 1e-4 : depth == kNothing;
          if (!same && !rim) ++wrong;
        }
      }
      CHECK(wrong == 0);
    }
  }

  TEST_CASE("a floor is exactly white where no light is missing, also outside the shadow maps") {
    Scene3 one;
    one.balls.push_back({{0, 0, 0.1}, 0.1, kRed});
    one.floor = Floor{};
    one.camera = {{0, -3, 3}, {0, 0, 0}, {0, 0, 1}, 6, false};  // far wider than the ball's maps
    one.subframes = 4;
    const Image image = paint_scene3(one, 200, 200);

    for (const auto& [x, y] : {std::pair{2, 2}, {197, 2}, {2, 197}, {197, 197}, {100, 180}}) {
      CHECK(brightness(image, x, y) == 3 * 255);
    }
    // The shadow lies opposite to the sun, behind the ball and to its right.
    const Vec<3> sun = one.lights.sun;
    const Pixel shadow =
        seen_at(one, Vec<3>(0, 0, 0.1) - 0.1 / sun[2] * sun + Vec<3>(0, 0, 0), 200, 200);
    CHECK(brightness(image, shadow.x, shadow.y) < 3 * 200);
  }

  TEST_CASE("a floor without anything on it, or seen from below, is not seen") {
    Scene3 one = scene(2);
    one.camera.eye = {0, -5, 5};
    one.floor = Floor{};
    CHECK(ink(paint_scene3(one, 50, 50)) == 0);

    one.balls.push_back({{0, 0, 0.3}, 0.3, kRed});
    one.camera.eye = {0, -5, -5};
    Scene3 without = one;
    without.floor.reset();
    CHECK((paint_scene3(one, 50, 50).rgba == paint_scene3(without, 50, 50).rgba));
  }

  TEST_CASE("a ball does not shade itself") {
    Scene3 one = one_ball();
    one.lights.sky_strength = 0;
    one.lights.sun = {0, -1, 0};  // from the viewer
    const Image image = paint_scene3(one, 201, 201);

    // Without a shadow the light falls off from the middle to the rim.
    for (int x = 101; x < 148; ++x) {
      CHECK(brightness(image, x + 1, 100) <= brightness(image, x, 100));
      CHECK(brightness(image, x, 100) - brightness(image, x + 1, 100) < 60);
    }
  }

  TEST_CASE("a ball between another and the sun shades it") {
    Scene3 one = one_ball();
    one.lights.sun = {0, 0, 1};
    one.lights.sky_strength = 0.1;
    const Pixel top = seen_at(one, {0, -0.6, 0.8}, 201, 201);
    const int lit = brightness(paint_scene3(one, 201, 201), top.x, top.y);
    one.balls.push_back({{0, 0, 5}, 1, kGreen});  // outside the picture

    const int shaded = brightness(paint_scene3(one, 201, 201), top.x, top.y);

    CHECK(shaded < lit / 2);
  }

  TEST_CASE("the same scene gives the same bytes, on any thread") {
    const Scene3 one = heap();
    const Image first = paint_scene3(one, 160, 120);
    Image other;

    std::thread([&] { other = paint_scene3(one, 160, 120); }).join();
    paint_rgba(test::mixed_list(), 50);

    CHECK((first.rgba == other.rgba));
    CHECK((first.rgba == paint_scene3(one, 160, 120).rgba));
  }

  TEST_CASE("a cut takes out its half-space and closes balls flat") {
    for (const bool perspective : {false, true}) {
      Scene3 one = one_ball(perspective);
      one.balls.push_back({{0, -3, 0}, 0.5, kGreen});  // in front, wholly taken out
      one.cuts.push_back({{0, -2, 0}, 0.6});           // y < -0.3
      const std::vector<double> depths = detail::depths(one, 101, 101);

      CHECK(relative_error(middle(depths), 4.7) < 1e-6);
      CHECK(relative_error(depths[50 * 101 + 62], 4.7) < 1e-6);  // flat
      CHECK(depths[50 * 101 + 76] > 4.71);                       // the ball beyond

      // The face has the ball's colour, a little darker, all over.
      const Image image = paint_scene3(one, 101, 101);
      for (int channel = 0; channel < 3; ++channel) {
        CHECK(pixel(image, 50, 50, channel) == pixel(image, 62, 44, channel));
      }
      CHECK(pixel(image, 50, 50, 0) < kRed.r);
      CHECK(pixel(image, 50, 50, 0) > 0.7 * kRed.r);
    }
  }

  TEST_CASE("a cut opens a tube too, and lets light in") {
    Scene3 one = scene(4);
    one.tubes.push_back({{-1, 0, 0}, {1, 0, 0}, 0.5, kRed});
    one.cuts.push_back({{0, -1, 0}, 0});
    CHECK(relative_error(middle(detail::depths(one, 101, 101)), 5) < 1e-6);

    one.cuts[0].offset = -0.6;
    CHECK(middle(detail::depths(one, 101, 101)) == kNothing);
  }

  TEST_CASE("a tube is a cylinder with round ends") {
    Scene3 one = scene(4);
    one.subframes = kPrintSubframes;
    one.tubes.push_back({{-1, 1, -0.5}, {1, 1, 0.7}, 0.25, kRed});
    const double length = std::hypot(2, 1.2);
    CHECK(relative_error(covered(one, 400), (length * 0.5 + std::numbers::pi / 16) * 100 * 100) <
          2e-3);

    // Obliquely towards the eye: the surface lies r / sin(angle) before the axis.
    one.tubes = {{{0, -1, -1}, {0, 1, 1}, 0.25, kRed}};
    for (const bool perspective : {false, true}) {
      one.camera.perspective = perspective;
      CHECK(relative_error(middle(detail::depths(one, 101, 101)), 5 - 0.25 * std::numbers::sqrt2) <
            1e-6);
    }
  }

  TEST_CASE("a line of constant width appears where its ends are projected") {
    for (const bool perspective : {false, true}) {
      Scene3 one = scene(4, perspective);
      const Vec<3> a(-1, 2, -1), b(1, -1, 1.1);
      one.lines.push_back({a, b, {kBlack, 5}});
      const Image image = paint_scene3(one, 200, 200);

      for (const double t : {0.02, 0.5, 0.98}) {
        const Pixel p = seen_at(one, a + t * (b - a), 200, 200);
        CHECK(brightness(image, p.x, p.y) == 0);
      }
      const View3 view(one.camera, {{0, 0}, {200, 200}});
      CHECK(relative_error(ink(image), 5 * ((view.point(b) - view.point(a)).norm() + 5)) < 0.02);

      // Its middle is behind a ball that stands before it, and before one that stands behind.
      one.balls.push_back({0.5 * (a + b) - Vec<3>(0, 1, 0), 0.3, kRed});
      const Pixel p = seen_at(one, 0.5 * (a + b), 200, 200);
      CHECK(pixel(paint_scene3(one, 200, 200), p.x, p.y, 0) > 50);
      one.balls[0].centre[1] += 2;
      CHECK(pixel(paint_scene3(one, 200, 200), p.x, p.y, 0) == 0);
    }
  }

  TEST_CASE("a line on the floor is seen for its whole width and length") {
    for (const bool perspective : {false, true}) {
      Scene3 one = scene(4, perspective);
      one.camera.eye = {1, -5, 1.5};
      const Vec<3> a(-1, -1, 0), b(1, 1, 0);
      one.lines.push_back({a, b, {kBlack, 4}});
      const double line = ink(paint_scene3(one, 200, 200));
      one.floor = Floor{};

      CHECK(ink(paint_scene3(one, 200, 200)) == line);

      // Nor does it make the rest of the floor disappear.
      one.balls.push_back({{0, 0, 1}, 0.5, kRed});
      one.lights = {};
      const double with_shadow = ink(paint_scene3(one, 200, 200));
      one.floor.reset();
      CHECK(with_shadow > ink(paint_scene3(one, 200, 200)) + 100);
    }
  }

  TEST_CASE("a pane tints what is behind it and not what is before") {
    for (const bool perspective : {false, true}) {
      Scene3 one = scene(4, perspective);
      one.balls.push_back({{-0.5, 1, 0}, 0.3, kRed});
      one.balls.push_back({{0.5, -1, 0}, 0.3, kRed});
      const Image clear = paint_scene3(one, 200, 200);
      // Corners in either sense of rotation.
      for (const bool turn : {false, true}) {
        Pane pane{{{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}}, {0, 0, 255, 128}};
        if (turn) std::swap(pane.corners[1], pane.corners[3]);
        one.panes = {pane};
        const Image tinted = paint_scene3(one, 200, 200);

        const Pixel behind = seen_at(one, {-0.5, 0.7, 0}, 200, 200),
                    before = seen_at(one, {0.5, -1.3, 0}, 200, 200);
        CHECK(pixel(tinted, behind.x, behind.y, 2) > pixel(clear, behind.x, behind.y, 2) + 50);
        CHECK(brightness(tinted, before.x, before.y) == brightness(clear, before.x, before.y));
        for (const double s : {-1.0, 1.0}) {
          const Pixel in = seen_at(one, {0.97 * s, 0, 0.97 * s}, 200, 200),
                      out = seen_at(one, {1.03 * s, 0, 0.97 * s}, 200, 200);
          CHECK(pixel(tinted, in.x, in.y, 0) < 255);
          CHECK(pixel(tinted, in.x, in.y, 2) == 255);
          CHECK(pixel(tinted, out.x, out.y, 0) == 255);
        }
      }
    }
  }

  TEST_CASE("an outline darkens the rim of what is nearer") {
    Scene3 one = one_ball();
    const Image without = paint_scene3(one, 201, 201);
    one.outline = {kBlack, 1};
    const Image with = paint_scene3(one, 201, 201);

    CHECK(brightness(with, 100, 100) == brightness(without, 100, 100));
    CHECK(brightness(with, 50, 100) < brightness(without, 50, 100) / 2);
  }

  TEST_CASE("a transparent picture keeps the shadow and the balls only") {
    Scene3 one = heap();
    one.panes.clear();
    one.background.a = 0;
    const Image image = paint_scene3(one, 160, 160);

    CHECK(pixel(image, 1, 1, 3) == 0);
    const Pixel ball = seen_at(one, one.balls[0].centre, 160, 160);
    CHECK(pixel(image, ball.x, ball.y, 3) == 255);
  }

  TEST_CASE("a camera frames a box from any side, by all four margins it can reach") {
    const Box3 box{{1, 2, 3}, {3, 5, 4}};
    for (const double field : {0.0, 0.6}) {
      for (const double aspect : {0.7, 1.0, 2.0}) {
        for (const Vec<3>& direction :
             {Vec<3>(0, 1, 0), Vec<3>(1, 2, -1), Vec<3>(0, 0, 1), Vec<3>(0, 0, -1)}) {
          const Vec<3> up = direction.head<2>().norm() > 0 ? Vec<3>(0, 0, 1) : Vec<3>(0, 1, 0);
          const Camera camera = camera_framing(box, direction, up, aspect, field, 0.05);
          const View3 view(camera, {{0, 0}, {100 * aspect, 100}});

          Vec<2> low(kNothing, kNothing), high = -low;
          for (int k = 0; k < 8; ++k) {
            const Vec<3> corner((k & 1) != 0 ? 1 : 3, (k & 2) != 0 ? 2 : 5, (k & 4) != 0 ? 3 : 4);
            low = low.cwiseMin(view.point(corner));
            high = high.cwiseMax(view.point(corner));
          }
          const Vec<2> page(100 * aspect, 100);
          CHECK((low.array() > 0.0499 * page.array()).all());
          CHECK((high.array() < 0.9501 * page.array()).all());
          CHECK(relative_error(((high - low).array() / page.array()).maxCoeff(), 0.9) < 1e-9);
          CHECK((low + high - page).norm() < (field > 0 ? 15 : 1e-9));
        }
      }
    }
  }

  TEST_CASE("points and lengths are projected to the page") {
    const Box page{{10, 20}, {110, 70}};
    for (const bool perspective : {false, true}) {
      const Camera camera{{0, -5, 0}, {0, 0, 0}, {0, 0, 1}, 2, perspective};
      const View3 view(camera, page);

      CHECK((view.point({0, 3, 0}) - Vec<2>(60, 45)).norm() < 1e-12);
      CHECK((view.point({0.4, 0, 1}) - Vec<2>(70, 70)).norm() < 1e-12);
      CHECK(relative_error(view.depth({7, 1, 2}), 6) < 1e-15);
      CHECK(relative_error(view.scale({0, 0, 0}), 25) < 1e-15);
      CHECK(relative_error(view.scale({0, 5, 0}), perspective ? 12.5 : 25) < 1e-15);
    }
  }

  TEST_CASE("seen from below, the page turns and the light comes from the viewer's side") {
    const Box3 box{{0, 0, 0}, {1, 1, 1}};
    Scene3 one;
    one.camera = camera_framing(box, {0, 0, 1}, {0, 1, 0});
    one.lights = over_the_shoulder(one.camera);
    one.balls.push_back({{0.5, 0.5, 0.3}, 0.3, kRed});
    one.subframes = 1;
    const Image image = paint_scene3(one, 101, 101);

    CHECK(one.lights.sun[2] < 0);
    CHECK(one.lights.zenith[2] < 0);
    CHECK(pixel(image, 50, 50, 0) > 150);
    // x runs to the left: the upper left of the page, where the sun stands, is at large x and y.
    CHECK(seen_at(one, {0.9, 0.9, 0}, 101, 101).x < 50);
    CHECK(brightness(image, 38, 38) > brightness(image, 62, 62));
  }

  TEST_CASE("a picture of a scene lies at its place beneath vector labels, in every output") {
    Scene3 one = one_ball();
    one.subframes = 4;
    DisplayList list{120, 100};
    const Box box{{10, 10}, {90, 90}};
    list.add(paint_scene3(one, box, 144));
    list.add(Label{"$r$ = 1 m", View3(one.camera, box).point({0, 0, 1.2}), 8});

    const auto& picture = std::get<Picture>(list.items[0]);
    CHECK(picture.image.width == 160);
    for (const Image& image : {paint_rgba(list, 72), detail::paint_rgba_cairo(list, 72)}) {
      // The ball fills the middle half of the box.
      CHECK(pixel(image, 50, 49, 1) < 150);
      CHECK(pixel(image, 32, 49, 1) < 150);
      CHECK(pixel(image, 68, 49, 1) < 150);
      CHECK(pixel(image, 28, 49, 1) == 255);
      CHECK(pixel(image, 72, 49, 1) == 255);
    }
    CHECK(test::psnr(paint_rgba(list, 144), detail::paint_rgba_cairo(list, 144)) >= 40);

    const std::string pdf = detail::encode_pdf(list);
    CHECK(pdf.find("/Subtype /Image") != std::string::npos);
    CHECK(pdf.find("/Width 160") != std::string::npos);
    CHECK(pdf.find("/FontFile") != std::string::npos);
  }

  TEST_CASE("scenes that cannot be painted are refused with their numbers") {
    const Scene3 good = one_ball();
    CHECK_THROWS_AS(paint_scene3(good, 0, 10), ContractError);
    CHECK_THROWS_WITH_AS(paint_scene3(good, 20000, 10), doctest::Contains("20000 x 10"),
                         SceneError);
    Scene3 bad = good;
    bad.camera.up = {0, 1, 0};
    CHECK_THROWS_AS(paint_scene3(bad, 10, 10), ContractError);
    bad = good;
    bad.camera.height = 0;
    CHECK_THROWS_AS(paint_scene3(bad, 10, 10), ContractError);
    bad = good;
    bad.subframes = 0;
    CHECK_THROWS_AS(paint_scene3(bad, 10, 10), ContractError);
    bad = good;
    bad.cuts.resize(9);
    CHECK_THROWS_AS(paint_scene3(bad, 10, 10), ContractError);
    bad = good;
    bad.panes.push_back({{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}}});
    CHECK_THROWS_AS(paint_scene3(bad, 10, 10), ContractError);
    bad = good;
    bad.lights.sun.setZero();
    CHECK_THROWS_AS(paint_scene3(bad, 10, 10), ContractError);
    CHECK_THROWS_AS(camera_framing({}, {0, 1, 0}), ContractError);
    CHECK(covered(good, 101) > 0);  // the painter is as good as before
  }

  TEST_CASE("an empty scene, and bodies without size, are blank") {
    Scene3 one = scene(2);
    CHECK(ink(paint_scene3(one, 20, 20)) == 0);
    one.balls.push_back({{0, 0, 0}, 0, kRed});
    one.tubes.push_back({{0, 0, 0}, {1, 0, 0}, 0, kRed});
    one.lines.push_back({{0, 0, 0}, {1, 0, 0}, {kBlack, 0}});
    CHECK(ink(paint_scene3(one, 20, 20)) == 0);
  }

  TEST_CASE("what reaches behind the eye is left out of a perspective picture") {
    Scene3 one = one_ball(true);
    const Image alone = paint_scene3(one, 60, 60);
    one.balls.push_back({{0, -5.2, 0}, 0.5, kGreen});
    one.tubes.push_back({{0, -7, 0}, {0, -2, 0}, 0.1, kGreen});
    one.lines.push_back({{0, -7, 0.2}, {0, -2, 0}, {kGreen, 3}});
    const Image more = paint_scene3(one, 60, 60);

    CHECK(std::abs(brightness(alone, 30, 30) - brightness(more, 30, 30)) < 300);
    CHECK(pixel(more, 30, 30, 0) > pixel(more, 30, 30, 1));
    CHECK(relative_error(middle(detail::depths(one, 61, 61)), 4) < 1e-6);
  }
}
