// SPDX-License-Identifier: GPL-3.0-or-later
#include "paint3_gl.hpp"

#include "gl.hpp"
#include "shaders3.hpp"
#include "sieve3.hpp"

#include <lagrain/check.hpp>
#include <lagrain/paint.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

// A picture is the mean of sub-frames. Each has its own sun, its own few lights of the sky and
// pixels moved by a fraction, so that the mean has smooth edges, soft shadows and gaps that darken
// with depth; there is no noise and no blur, and the same scene gives the same bytes.
//
// A sub-frame: (1) for every light a shadow map, the depth of what the light sees; (2) for every
// pixel which body is seen and how deep; (3) one pass over the pixels that finds the point
// again, asks the shadow maps, and adds the light to the sum. Balls are quads whose fragments
// solve for the ray's way through the sphere; depth is written by the fragment, linear along the
// line of sight.
//
// Bodies are convex. A ray of light that meets one has a stretch inside it; whatever lies before
// that stretch is lit, whatever lies behind it is not. Shadow maps therefore keep the middle of the
// stretch: a body cannot shade itself, no offset against that is needed, and a map may be coarse.
// For a ball the middle is the depth of its centre, the same for all its fragments.
//
// Lengths are in units of the scene's radius from here on, positions relative to its middle: single
// precision is enough for any scene.

namespace lagrain {
namespace {

using detail::Body;
using detail::Drawn;
using detail::Vec2f;
using detail::Vec3f;
using detail::View;

namespace source = detail::shaders3;

constexpr float kMapReach = 1.02F;  // half the width of a shadow map; the scene's radius is 1

// Lights of the sky in a sub-frame. Their directions differ from one sub-frame to the next; a
// picture of a single one has to do without that, and gets more of them.
constexpr int kSkyLights = 4, kSkyLightsAlone = 8;
static_assert(std::max(kSkyLights, kSkyLightsAlone) < source::kMostLights);

// Sides of the tiles of the sieve, in pixels of the picture and in texels of a shadow map. Any size
// gives the same picture. Half or twice of these changes the time by a tenth at most (6,859 balls
// on 800 x 800 pixels).
constexpr int kPictureTile = 4, kMapTile = 2;

float from_srgb(std::uint8_t value) {
  const double v = value / 255.0;
  return static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
}

std::array<float, 4> linear(Colour c) {
  return {from_srgb(c.r), from_srgb(c.g), from_srgb(c.b), static_cast<float>(c.a) / 255};
}

View light_view(const Vec3f& towards, int index, const Vec2f& jitter) {
  View view;
  const Vec3f right = towards.unitOrthogonal();
  view.axes.row(0) = right;
  view.axes.row(1) = towards.cross(right);
  view.axes.row(2) = towards;
  view.shift = {0, 0, -kMapReach};
  view.half_size.setConstant(kMapReach);
  view.jitter = jitter;
  view.extent = 2 * kMapReach;
  view.x = index * source::kMapSize;
  view.width = view.height = source::kMapSize;
  return view;
}

// Radical inverse: 1, 2, 3, ... spread evenly over (0, 1).
double halton(int index, int base) {
  double sum = 0, part = 1;
  for (; index > 0; index /= base) {
    part /= base;
    sum += part * (index % base);
  }
  return sum;
}

class Painter {
 public:
  Painter() {
    const std::string view = gl::kVersion + gl::define("MAP_SIZE", source::kMapSize) +
                             gl::define("BODIES_PER_ROW", source::kBodiesPerRow) +
                             gl::define("MOST_CUTS", source::kMostCuts) +
                             gl::define("MOST_LIGHTS", source::kMostLights) + source::kView;
    const std::string body = view + source::kBodyVertexShader;
    ball_ = gl::program(body, view + source::kBallFragmentShader);
    body_ = gl::program(body, view + source::kBodyFragmentShader);
    line_ = gl::program(view + source::kLineVertexShader, view + source::kLineFragmentShader);
    ball_shadow_ = gl::program(view + source::kBallShadowVertexShader,
                               view + source::kBallShadowFragmentShader);
    body_shadow_ = gl::program(body, view + "#define SHADOW\n" + source::kBodyFragmentShader);
    light_ = gl::program(gl::kWholeVertexShader, view + source::kLightFragmentShader);
    develop_ = gl::program(gl::kWholeVertexShader, source::kDevelopFragmentShader);
    gl::GenVertexArrays(1, &array_);
    gl::GenBuffers(1, &buffer_);
    gl::BindVertexArray(array_);
    gl::BindBuffer(GL_ARRAY_BUFFER, buffer_);
    for (const GLuint at : {0U, 1U}) {
      gl::EnableVertexAttribArray(at);
      gl::VertexAttribPointer(at, 4, GL_FLOAT, GL_FALSE, sizeof(Body),
                              reinterpret_cast<const void*>(std::size_t{16} * at));
      gl::VertexAttribDivisor(at, 1);
    }
  }

  Image paint(const Scene3& scene, int width, int height, double dpi) {
    take(scene, width, height, dpi);
    const int frames = scene.subframes;
    const int sky = frames == 1 ? kSkyLightsAlone : kSkyLights;

    sum_.bind(width, height);
    gl::ClearColor(0, 0, 0, 0);
    gl::Clear(GL_COLOR_BUFFER_BIT);
    std::vector<Vec2f> jitters;
    Vec2f mean = Vec2f::Zero();
    for (int frame = 0; frame < frames; ++frame) {
      jitters.emplace_back(static_cast<float>(halton(frame + 1, 2)),
                           static_cast<float>(halton(frame + 1, 3)));
      mean += jitters.back() / static_cast<float>(frames);
    }
    for (int frame = 0; frame < frames; ++frame) {
      const Vec2f jitter = 2 * (jitters[static_cast<std::size_t>(frame)] - mean);
      see(jitter);
      shine(scene, frame, frames, sky, jitter);
      add(scene, frames, sky + 1, jitter, dpi);
    }

    developed_.bind(width, height);
    gl::UseProgram(develop_);
    set(develop_, "sum", 0);
    set(develop_, "background", linear(scene.background));
    gl::bind_texture(0, sum_.colour());
    gl::draw_whole();
    return gl::read_image(width, height);
  }

  std::vector<double> depths(const Scene3& scene, int width, int height) {
    take(scene, width, height, 72);
    see(Vec2f::Zero());
    const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::vector<float> ids(count), depth(count);
    gl::PixelStorei(GL_PACK_ALIGNMENT, 4);
    gl::ReadPixels(0, 0, width, height, GL_RED, GL_FLOAT, ids.data());
    gl::ReadPixels(0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, depth.data());
    std::vector<double> metres(count, std::numeric_limits<double>::infinity());
    for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
      for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
        const std::size_t from = y * static_cast<std::size_t>(width) + x,
                          to = count - (y + 1) * static_cast<std::size_t>(width) + x;
        if (ids[from] < 0) continue;
        metres[to] = unit_ * (static_cast<double>(view_.nearest) +
                              static_cast<double>(view_.extent) * static_cast<double>(depth[from]));
      }
    }
    return metres;
  }

 private:
  // ---- from the scene to bodies ----

  std::array<float, 3> place(const Vec<3>& p) const {
    const Vec3f q = ((p - origin_) / unit_).cast<float>();
    return {q[0], q[1], q[2]};
  }

  void measure(const Scene3& scene) {
    const double inf = std::numeric_limits<double>::infinity();
    Vec<3> low = Vec<3>::Constant(inf), high = Vec<3>::Constant(-inf);
    const auto cover = [&](const Vec<3>& p, double r) {
      low = low.cwiseMin(Vec<3>(p.array() - r));
      high = high.cwiseMax(Vec<3>(p.array() + r));
    };
    for (const Ball& ball : scene.balls) cover(ball.centre, ball.radius);
    for (const Tube& tube : scene.tubes) cover(tube.from, tube.radius), cover(tube.to, tube.radius);
    if (scene.balls.empty() && scene.tubes.empty()) cover(scene.camera.target, scene.camera.height);
    origin_ = 0.5 * (low + high);
    unit_ = 0;
    const auto reach = [&](const Vec<3>& p, double r) {
      unit_ = std::max(unit_, (p - origin_).norm() + r);
    };
    for (const Ball& ball : scene.balls) reach(ball.centre, ball.radius);
    for (const Tube& tube : scene.tubes) reach(tube.from, tube.radius), reach(tube.to, tube.radius);
    if (!(unit_ > 0)) unit_ = scene.camera.height;
  }

  void add_body(std::vector<Body>& to, const Vec<3>& from, const Vec<3>& end, float radius,
                Colour colour, bool lit) {
    const auto id = static_cast<float>(table_.size() / 12);
    const Body body{place(from), radius, place(end), id};
    to.push_back(body);
    table_.insert(table_.end(), {body.from[0], body.from[1], body.from[2], lit ? radius : 0.0F,
                                 body.to[0], body.to[1], body.to[2], lit ? 0.0F : radius});
    const std::array<float, 4> c = linear(colour);
    table_.insert(table_.end(), {c[0], c[1], c[2], lit ? 1.0F : 0.0F});
  }

  // Takes in a scene: its bodies relative to its middle, what the cuts leave of them, and the
  // camera's view.
  void take(const Scene3& scene, int width, int height, double dpi) {
    measure(scene);
    balls_.clear(), is_cut_.clear(), tubes_.clear(), lines_.clear(), cuts_.clear(), table_.clear();
    for (const Cut& cut : scene.cuts) {
      const double length = cut.normal.norm();
      LAGRAIN_EXPECTS(length > 0, "Cut: the normal has no length");
      const Vec<3> n = cut.normal / length;
      cuts_.push_back({static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2]),
                       static_cast<float>((cut.offset / length - n.dot(origin_)) / unit_)});
    }
    // Tells how far a point reaches into what the cuts take out.
    const auto outside = [this](const std::array<float, 3>& p) {
      float most = -std::numeric_limits<float>::infinity();
      for (const std::array<float, 4>& cut : cuts_) {
        most = std::max(most, cut[0] * p[0] + cut[1] * p[1] + cut[2] * p[2] - cut[3]);
      }
      return most;
    };
    for (const Ball& ball : scene.balls) {
      const auto r = static_cast<float>(ball.radius / unit_);
      const float beyond = outside(place(ball.centre));
      if (!(r > 0) || beyond >= r) continue;
      add_body(balls_, ball.centre, ball.centre, r, ball.colour, true);
      is_cut_.push_back(beyond > -r ? 1 : 0);
    }
    for (const Tube& tube : scene.tubes) {
      const auto r = static_cast<float>(tube.radius / unit_);
      if (r > 0) add_body(tubes_, tube.from, tube.to, r, tube.colour, true);
    }
    for (const Line3& line : scene.lines) {
      if (!(line.stroke.width > 0)) continue;
      const double half = 0.5 * std::max(1.0, line.stroke.width * dpi / 72);
      add_body(lines_, line.a, line.b, static_cast<float>(half), line.stroke.colour, false);
    }
    const std::size_t row = std::size_t{12} * source::kBodiesPerRow;
    if (table_.size() > row * gl::kLargest) {
      throw SceneError("a scene of " + std::to_string(table_.size() / 12) +
                       " balls, tubes and lines is too large");
    }
    table_.resize(std::max<std::size_t>(1, (table_.size() + row - 1) / row) * row);
    upload(body_table_, 3 * source::kBodiesPerRow, table_);
    aim(scene.camera, width, height);
    take_panes(scene.panes);
  }

  void aim(const Camera& camera, int width, int height) {
    const Eigen::Matrix3d rows = page_axes(camera);
    view_.axes = rows.cast<float>();
    view_.shift = (rows * (origin_ - camera.eye) / unit_).cast<float>();
    view_.perspective = camera.perspective;
    const double at = camera.perspective ? (camera.eye - camera.target).norm() : unit_;
    const double half = 0.5 * camera.height / at;
    view_.half_size = Eigen::Vector2d(half * width / height, half).cast<float>();
    view_.width = width;
    view_.height = height;
    // A tube or a line that reaches behind the eye has no place in a perspective picture.
    const auto drop_behind = [this](std::vector<Body>& bodies, bool tubes) {
      std::erase_if(bodies, [&](const Body& body) {
        const float depth = -std::max(view_.seen(body.from)[2], view_.seen(body.to)[2]);
        return view_.perspective && depth - (tubes ? body.radius : 0) < detail::kLeastDepth;
      });
    };
    drop_behind(tubes_, true);
    drop_behind(lines_, false);
    float least = std::numeric_limits<float>::infinity(), most = -least;
    const auto cover = [&](const std::array<float, 3>& p, float r) {
      const float depth = -view_.seen(p)[2];
      least = std::min(least, depth - r);
      most = std::max(most, depth + r);
    };
    for (const Body& ball : balls_) cover(ball.from, ball.radius);
    for (const Body& tube : tubes_) cover(tube.from, tube.radius), cover(tube.to, tube.radius);
    for (const Body& line : lines_) cover(line.from, 0), cover(line.to, 0);
    if (view_.perspective) least = std::max(least, 0.0F);
    view_.nearest = least < most ? least : 0;
    // A little more, so that rounding takes nothing out of the range.
    view_.extent = least < most ? 1.001F * (most - least) : 1;
  }

  // Writes the panes into a table, the farthest first. A pane is a row of six texels: its plane
  // normal . x = offset, its four sides, within which normal . x <= offset, and its colour.
  void take_panes(std::vector<Pane> panes) {
    const auto depth = [this](const Pane& pane) {
      Vec<3> sum = Vec<3>::Zero();
      for (const Vec<3>& corner : pane.corners) sum += corner;
      return view_.seen(place(sum / 4))[2];
    };
    std::stable_sort(panes.begin(), panes.end(),
                     [&](const Pane& a, const Pane& b) { return depth(a) < depth(b); });
    std::vector<float> texels;
    const auto add_plane = [&](const Vec<3>& n, const Vec<3>& point) {
      for (int i = 0; i < 3; ++i) texels.push_back(static_cast<float>(n[i]));
      texels.push_back(static_cast<float>(n.dot(point - origin_) / unit_));
    };
    for (const Pane& pane : panes) {
      const auto& c = pane.corners;
      const Vec<3> normal = (c[2] - c[0]).cross(c[3] - c[1]);
      LAGRAIN_EXPECTS(normal.norm() > 0, "Pane: the corners span no area");
      add_plane(normal.normalized(), c[0]);
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec<3> side = (c[(k + 1) % 4] - c[k]).cross(normal);
        add_plane(side.norm() > 0 ? side.normalized() : Vec<3>::Zero(), c[k]);
      }
      const std::array<float, 4> colour = linear(pane.colour);
      texels.insert(texels.end(), colour.begin(), colour.end());
    }
    pane_count_ = static_cast<int>(panes.size());
    if (panes.empty()) texels.resize(24);
    upload(pane_table_, 6, texels);
  }

  static void upload(GLuint& texture, int width, const std::vector<float>& texels) {
    if (texture != 0) gl::DeleteTextures(1, &texture);
    gl::ActiveTexture(GL_TEXTURE0);
    texture = gl::texture(GL_RGBA32F, width, static_cast<int>(texels.size()) / (4 * width), GL_RGBA,
                          GL_FLOAT, texels.data(), GL_NEAREST);
  }

  // ---- passes ----

  // Draws which body is seen through each pixel, and how deep.
  void see(const Vec2f& jitter) {
    view_.jitter = {jitter[0] / static_cast<float>(view_.width),
                    jitter[1] / static_cast<float>(view_.height)};
    seen_.bind(view_.width, view_.height);
    gl::Disable(GL_BLEND);
    gl::Enable(GL_DEPTH_TEST);
    gl::DepthFunc(GL_LESS);
    gl::ClearColor(-1, 0, 0, 0);
    gl::Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    Drawn drawn;
    drawn.others = tubes_;
    sieve_.sift(view_, balls_, is_cut_, kPictureTile, false, drawn);
    draw(ball_, view_, drawn.balls);
    draw(body_, view_, drawn.others);
    draw(line_, view_, lines_);
    gl::Disable(GL_DEPTH_TEST);
  }

  // Chooses the lights of a sub-frame and draws their shadow maps.
  void shine(const Scene3& scene, int frame, int frames, int sky, const Vec2f& jitter) {
    // The golden angle, pi (3 - sqrt 5): its multiples spread evenly over the circle.
    constexpr double kGolden = std::numbers::pi * (3 - 2.2360679774997896964);
    const auto around = [](const Vec<3>& axis, double cosine, double angle) -> Vec3f {
      const Vec<3> middle = axis.normalized(), right = middle.unitOrthogonal(),
                   up = middle.cross(right);
      const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
      return (cosine * middle + sine * (std::cos(angle) * right + std::sin(angle) * up))
          .cast<float>();
    };
    lights_.clear();
    strengths_.clear();
    const double rim = std::sqrt((frame + 0.5) / frames) * scene.lights.sun_radius;
    const Vec2f map_jitter = jitter / static_cast<float>(source::kMapSize);
    lights_.push_back(
        light_view(around(scene.lights.sun, std::cos(rim), kGolden * frame), 0, map_jitter));
    strengths_.push_back(static_cast<float>(scene.lights.sun_strength));
    // The lights stand evenly over the hemisphere; a surface that sees all of it gets the
    // full strength.
    for (int k = 0; k < sky; ++k) {
      const int index = frame + k * frames;
      const double cosine = 1 - (index + 0.5) / (frames * sky);
      lights_.push_back(
          light_view(around(scene.lights.zenith, cosine, kGolden * index), k + 1, map_jitter));
      strengths_.push_back(static_cast<float>(2 * scene.lights.sky_strength / sky));
    }

    shadows_.bind(source::kMapSize * (sky + 1), source::kMapSize);
    gl::Enable(GL_DEPTH_TEST);
    gl::DepthFunc(GL_LESS);
    gl::Clear(GL_DEPTH_BUFFER_BIT);
    for (const View& light : lights_) {
      gl::Viewport(light.x, 0, source::kMapSize, source::kMapSize);
      Drawn drawn;
      drawn.others = tubes_;
      sieve_.sift(light, balls_, is_cut_, kMapTile, true, drawn);
      draw(ball_shadow_, light, drawn.balls);
      draw(body_shadow_, light, drawn.others);
    }
    gl::Disable(GL_DEPTH_TEST);
  }

  // Adds the light on what is seen to the sum.
  void add(const Scene3& scene, int frames, int lights, const Vec2f& jitter, double dpi) {
    sum_.bind(view_.width, view_.height);
    gl::Enable(GL_BLEND);
    gl::BlendFunc(GL_ONE, GL_ONE);
    gl::UseProgram(light_);
    set(light_, view_);
    const std::array<std::pair<const char*, GLuint>, 5> textures{{{"ids", seen_.colour()},
                                                                  {"depths", seen_.depth()},
                                                                  {"bodies", body_table_},
                                                                  {"panes", pane_table_},
                                                                  {"shadows", shadows_.depth()}}};
    for (std::size_t unit = 0; unit < textures.size(); ++unit) {
      set(light_, textures[unit].first, static_cast<int>(unit));
      gl::bind_texture(static_cast<int>(unit), textures[unit].second);
    }
    std::vector<float> directions;
    for (const View& light : lights_) {
      for (int row = 0; row < 3; ++row) {
        for (int i = 0; i < 3; ++i) directions.push_back(light.axes(row, i));
      }
    }
    gl::Uniform3fv(at(light_, "light_axes"), 3 * lights, directions.data());
    gl::Uniform1fv(at(light_, "strength"), lights, strengths_.data());
    set(light_, "lights", lights);
    gl::Uniform1f(at(light_, "map_reach"), kMapReach);
    gl::Uniform2f(at(light_, "map_jitter"), jitter[0] / source::kMapSize,
                  jitter[1] / source::kMapSize);
    set(light_, "pane_count", pane_count_);
    set(light_, "has_ground", scene.floor ? 1 : 0);
    if (scene.floor) {
      const Vec<3> n = scene.floor->normal.normalized();
      set(light_, "ground",
          {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2]),
           static_cast<float>((scene.floor->height - n.dot(origin_)) / unit_)});
    }
    // An outline below a pixel becomes fainter, not thinner.
    const double outline = scene.outline.width * dpi / 72;
    std::array<float, 4> ink = linear(scene.outline.colour);
    ink[3] *= static_cast<float>(std::clamp(outline, 0.0, 1.0));
    set(light_, "outline", ink);
    set(light_, "outline_pixels", std::max(1, static_cast<int>(std::lround(outline))));
    gl::Uniform1f(at(light_, "weight"), 1 / static_cast<float>(frames));
    gl::draw_whole();
    gl::Disable(GL_BLEND);
  }

  static GLint at(GLuint program, const char* name) {
    return gl::GetUniformLocation(program, name);
  }
  static void set(GLuint program, const char* name, int value) {
    gl::Uniform1i(at(program, name), value);
  }
  static void set(GLuint program, const char* name, const std::array<float, 4>& value) {
    gl::Uniform4fv(at(program, name), 1, value.data());
  }
  static void set(GLuint program, const View& view) {
    gl::UniformMatrix3fv(at(program, "axes"), 1, GL_FALSE, view.axes.data());
    gl::Uniform3fv(at(program, "shift"), 1, view.shift.data());
    gl::Uniform2f(at(program, "half_size"), view.half_size[0], view.half_size[1]);
    gl::Uniform2f(at(program, "jitter"), view.jitter[0], view.jitter[1]);
    gl::Uniform1f(at(program, "perspective"), view.perspective ? 1 : 0);
    gl::Uniform2f(at(program, "range"), view.nearest, view.extent);
    set(program, "window",
        {static_cast<float>(view.x), 0, static_cast<float>(view.width),
         static_cast<float>(view.height)});
  }

  void draw(GLuint program, const View& view, const std::vector<Body>& bodies) {
    if (bodies.empty()) return;
    gl::UseProgram(program);
    set(program, view);
    // The shaders want the cuts in the coordinates of the view.
    std::vector<float> cuts;
    for (const std::array<float, 4>& cut : cuts_) {
      const Vec3f n = view.axes * Eigen::Map<const Vec3f>(cut.data());
      cuts.insert(cuts.end(), {n[0], n[1], n[2], cut[3] + n.dot(view.shift)});
    }
    set(program, "cut_count", static_cast<int>(cuts_.size()));
    if (!cuts_.empty()) {
      gl::Uniform4fv(at(program, "cuts"), static_cast<GLsizei>(cuts_.size()), cuts.data());
    }
    gl::BindVertexArray(array_);
    gl::BindBuffer(GL_ARRAY_BUFFER, buffer_);
    gl::BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bodies.size() * sizeof(Body)),
                   bodies.data(), GL_STREAM_DRAW);
    gl::DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(bodies.size()));
  }

  GLuint ball_ = 0, body_ = 0, line_ = 0, ball_shadow_ = 0, body_shadow_ = 0;
  GLuint light_ = 0, develop_ = 0, array_ = 0, buffer_ = 0;
  GLuint body_table_ = 0, pane_table_ = 0;
  gl::Target seen_{GL_R32F, GL_DEPTH_COMPONENT32F}, shadows_{0, GL_DEPTH_COMPONENT32F};
  gl::Target sum_{GL_RGBA32F, 0}, developed_{GL_RGBA8, 0};

  Vec<3> origin_ = Vec<3>::Zero();  // the scene's middle [m]
  double unit_ = 1;                 // its radius [m]
  View view_;
  std::vector<Body> balls_, tubes_, lines_;
  std::vector<char> is_cut_;  // for each ball: a cut goes through it
  std::vector<std::array<float, 4>> cuts_;
  std::vector<float> table_;
  int pane_count_ = 0;
  std::vector<View> lights_;
  std::vector<float> strengths_;
  detail::Sieve sieve_;
};

Painter& painter() {
  static Painter* const one = new Painter;  // never destroyed, like the context
  return *one;
}

void expect_paintable(const Scene3& scene, int width, int height) {
  LAGRAIN_EXPECTS(width > 0 && height > 0, "paint_scene3: a picture of " + std::to_string(width) +
                                               " x " + std::to_string(height) + " pixels");
  LAGRAIN_EXPECTS(scene.camera.height > 0 && scene.subframes >= 1,
                  "paint_scene3: the camera's height is " + std::to_string(scene.camera.height) +
                      " m, the number of sub-frames " + std::to_string(scene.subframes));
  LAGRAIN_EXPECTS(scene.cuts.size() <= source::kMostCuts,
                  "paint_scene3: " + std::to_string(scene.cuts.size()) + " cuts");
  LAGRAIN_EXPECTS(scene.lights.sun.norm() > 0 && scene.lights.zenith.norm() > 0 &&
                      (!scene.floor || scene.floor->normal.norm() > 0),
                  "paint_scene3: the direction of the sun, the sky or the floor has no length");
  if (std::max(width, height) > gl::kLargest) {
    throw SceneError("a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                     " pixels is too large: at most " + std::to_string(gl::kLargest) +
                     " pixels along a side");
  }
}

}  // namespace

namespace detail {

std::vector<double> depths(const Scene3& scene, int width, int height) {
  expect_paintable(scene, width, height);
  const gl::Current current;
  return painter().depths(scene, width, height);
}

}  // namespace detail

Image paint_scene3(const Scene3& scene, int width, int height, double dpi) {
  expect_paintable(scene, width, height);
  LAGRAIN_EXPECTS(dpi > 0, "paint_scene3: " + std::to_string(dpi) + " dpi");
  const gl::Current current;
  return painter().paint(scene, width, height, dpi);
}

Picture paint_scene3(const Scene3& scene, const Box& box, double dpi) {
  const auto pixels = [dpi](double points) {
    return std::max(1, static_cast<int>(std::lround(points * dpi / 72)));
  };
  const Vec<2> size = box.size();
  return {paint_scene3(scene, pixels(size[0]), pixels(size[1]), dpi), box};
}

}  // namespace lagrain
