// SPDX-License-Identifier: GPL-3.0-or-later
#include "own_picture.hpp"

#include "force_scale.hpp"
#include "geometry_drawing.hpp"

#include <lagrain/laguerre2.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/skins.hpp>
#include <lagrain/style.hpp>
#include <lagrain/text.hpp>
#include <lagrain/wall_shapes.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace lagrain::figures {
namespace {

constexpr double kFitWidth = 380, kFitHeight = 330;  // of the picture on its page, at most [pt]
constexpr double kEdge = 6;                          // around everything [pt]
constexpr double kTop = 14, kBottom = 24;            // for the time, and the length bar [pt]
constexpr double kBarWidth = 9;                      // of a colour bar [pt]
constexpr double kThinGrain = 1.2;                   // radius below which none has an outline [pt]

// ---- Values and their colours -------------------------------------------------------------------

/// A quantity in a unit that gives readable numbers.
struct ReadableUnit {
  double factor = 1;
  std::string name;
};
ReadableUnit readable_unit(const std::string& unit, double largest) {
  if (largest > 0 && (unit == "m" || unit == "m/s") && largest < 0.1) return {1e3, "m" + unit};
  if (unit == "N" && largest > 0) {
    if (largest < 0.1) return {1e3, "mN"};
    if (largest >= 1e6) return {1e-6, "MN"};
    if (largest >= 1e3) return {1e-3, "kN"};
  }
  return {1, unit};
}

struct Quantity {
  std::string name, unit;
};
Quantity quantity_of(ColourBy colour) {
  switch (colour) {
    case ColourBy::speed:
      return {"speed", "m/s"};
    case ColourBy::force:
      return {"forces", "N"};
    case ColourBy::spin:
      return {"spin", "rad/s"};
    case ColourBy::radius:
      return {"radius", "m"};
    case ColourBy::coordination:
      return {"contacts", ""};
    case ColourBy::height:
      return {"height", "m"};
    default:
      return {};
  }
}

bool has_bar(ColourBy colour) { return !quantity_of(colour).name.empty(); }

template <int Dim>
std::vector<double> values_of(const Snapshot<Dim>& snapshot, ColourBy colour) {
  const Frame<Dim>& frame = snapshot.frame;
  std::vector<double> values(frame.id.size(), 0);
  if (colour == ColourBy::force || colour == ColourBy::coordination) {
    for (const ContactRecord<Dim>& c : *snapshot.contacts) {
      const double add = colour == ColourBy::force ? c.force.norm() : 1;
      values[static_cast<std::size_t>(c.i)] += add;
      if (c.j >= 0) values[static_cast<std::size_t>(c.j)] += add;
    }
    return values;
  }
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    switch (colour) {
      case ColourBy::speed:
        values[k] = frame.velocity.col(i).norm();
        break;
      case ColourBy::spin:
        values[k] = Dim == 2 ? (*frame.spin)(0, i) : frame.spin->col(i).norm();
        break;
      case ColourBy::radius:
        values[k] = frame.radius[i];
        break;
      default:
        values[k] = frame.position(Dim - 1, i);
    }
  }
  return values;
}

/// The name of a grain's category.
template <int Dim>
std::vector<std::string> categories_of(const Scene<Dim>& scene, const Snapshot<Dim>& snapshot,
                                       ColourBy colour) {
  if (colour == ColourBy::group) return snapshot.group;
  std::vector<std::string> names;
  for (const int m : snapshot.frame.material) {
    names.push_back(scene.materials[static_cast<std::size_t>(m)].name);
  }
  return names;
}

template <int Dim>
ColourBy default_colour(const Scene<Dim>& scene, const Snapshot<Dim>& snapshot) {
  const std::vector<int>& materials = snapshot.frame.material;
  if (std::adjacent_find(materials.begin(), materials.end(), std::not_equal_to<>()) !=
      materials.end()) {
    return ColourBy::material;
  }
  // At rest speeds are noise. Fast is what would rise by a hundredth of a diameter.
  const double gravity = scene.gravity.norm();
  const double rest = 2 * gravity * 0.02 * snapshot.frame.radius.mean();
  const double fastest = snapshot.frame.velocity.colwise().squaredNorm().maxCoeff();
  return fastest > rest ? ColourBy::speed : ColourBy::plain;
}

void need(bool there, const std::string& why) {
  if (!there) throw SceneError(why);
}

// ---- The window ---------------------------------------------------------------------------------

/// The box around all grains, but those few that are far away from all others.
template <int Dim>
Eigen::AlignedBox<double, Dim> box_of_grains(const Frame<Dim>& frame) {
  Eigen::AlignedBox<double, Dim> box;
  const auto n = frame.position.cols();
  const double largest = frame.radius.maxCoeff();
  for (int d = 0; d < Dim; ++d) {
    std::vector<double> low, high;
    for (Eigen::Index i = 0; i < n; ++i) {
      low.push_back(frame.position(d, i) - frame.radius[i]);
      high.push_back(frame.position(d, i) + frame.radius[i]);
    }
    std::sort(low.begin(), low.end());
    std::sort(high.begin(), high.end());
    const auto few = static_cast<std::size_t>(0.02 * static_cast<double>(n));
    const double a = low[few], b = high[high.size() - 1 - few];
    const double room = 2 * (b - a) + 4 * largest;
    box.min()[d] = low.front() < a - room ? a - 0.1 * (b - a) : low.front();
    box.max()[d] = high.back() > b + room ? b + 0.1 * (b - a) : high.back();
  }
  return box;
}

template <int Dim>
Eigen::AlignedBox<double, Dim> box_of_wall(const Wall<Dim>& wall, const Vec<Dim>& middle) {
  Eigen::AlignedBox<double, Dim> box;
  if (const auto* round = std::get_if<Cylinder<Dim>>(&wall.shape)) {
    const Vec<Dim> centre = wall.point + (middle - wall.point).dot(round->axis) * round->axis;
    Vec<Dim> reach;
    for (int d = 0; d < Dim; ++d) {
      reach[d] = round->radius * std::sqrt(std::max(0.0, 1 - round->axis[d] * round->axis[d]));
    }
    box = {centre - reach, centre + reach};
  } else if (const Sheet<Dim>* sheet = wall.pieces()) {
    const WallPose<Dim> pose = wall.pose();
    const Eigen::AlignedBox<double, Dim> own = sheet->box();
    for (int k = 0; k < (1 << Dim); ++k) {
      Vec<Dim> corner = own.min();
      for (int d = 0; d < Dim; ++d) {
        if ((k >> d & 1) != 0) corner[d] = own.max()[d];
      }
      box.extend(Vec<Dim>(pose.point + pose.frame * corner));
    }
  }
  return box;
}

template <int Dim>
Eigen::AlignedBox<double, Dim> window_of(const Scene<Dim>& scene, const Snapshot<Dim>& snapshot,
                                         bool with_walls) {
  using AlignedBox = Eigen::AlignedBox<double, Dim>;
  AlignedBox box;
  if (snapshot.frame.id.empty()) {
    for (const auto& inlet : scene.inlets)
      box.extend(AlignedBox(inlet.region.low, inlet.region.high));
  } else {
    box = box_of_grains(snapshot.frame);
  }
  need(!box.isEmpty(), "there is no grain at t = " + rounded(snapshot.frame.time, 4) +
                           " s, so there is nothing to draw");
  if (with_walls) {
    // Walls far from all grains would make these small.
    const double far = box.diagonal().norm();
    const AlignedBox limit(box.min() - Vec<Dim>::Constant(far),
                           box.max() + Vec<Dim>::Constant(far));
    const AlignedBox grains = box;
    for (const Wall<Dim>& wall : snapshot.walls) {
      if (wall.gone) continue;
      if (const auto* plane = std::get_if<HalfSpace<Dim>>(&wall.shape)) {
        Eigen::Index axis = 0;
        if (plane->normal.cwiseAbs().maxCoeff(&axis) < 1 - 1e-9) continue;
        const double x = wall.point[axis];
        if (x < limit.min()[axis] || x > limit.max()[axis]) continue;
        box.min()[axis] = std::min(box.min()[axis], x);
        box.max()[axis] = std::max(box.max()[axis], x);
        continue;
      }
      const AlignedBox own = box_of_wall(wall, Vec<Dim>(grains.center())).intersection(limit);
      if (!own.isEmpty()) box.extend(own);
    }
    for (const auto& inlet : scene.inlets) {
      const AlignedBox own = AlignedBox(inlet.region.low, inlet.region.high).intersection(limit);
      if (!own.isEmpty()) box.extend(own);
    }
  }
  return box;
}

// ---- Walls in the plane -------------------------------------------------------------------------

/// The part of a straight line that lies in a box and in front of all half-spaces.
std::optional<std::array<Vec<2>, 2>> visible_part(const Wall<2>& wall, const Box& window,
                                                  const std::vector<Wall<2>>& walls) {
  const Vec<2> normal = std::get<HalfSpace<2>>(wall.shape).normal;
  const Vec<2> along(-normal[1], normal[0]);
  const Vec<2> foot = wall.point + (window.centre() - wall.point).dot(along) * along;
  double from = -2 * window.size().norm(), to = -from;
  // Keeps what lies on the side of a point to which a direction shows.
  const auto cut = [&](const Vec<2>& point, const Vec<2>& inside) {
    const double slope = along.dot(inside), height = (foot - point).dot(inside);
    const double slack = 1e-9 * window.size().norm();
    if (std::abs(slope) < 1e-12) {
      if (height < -slack) to = from;
    } else if (slope > 0) {
      from = std::max(from, -height / slope);
    } else {
      to = std::min(to, -height / slope);
    }
  };
  cut(window.low, {1, 0});
  cut(window.low, {0, 1});
  cut(window.high, {-1, 0});
  cut(window.high, {0, -1});
  for (const Wall<2>& other : walls) {
    const auto* plane = std::get_if<HalfSpace<2>>(&other.shape);
    if (plane != nullptr && &other != &wall && !other.gone) cut(other.point, plane->normal);
  }
  if (!(from < to)) return std::nullopt;
  return std::array<Vec<2>, 2>{foot + from * along, foot + to * along};
}

void add_walls(DisplayList& list, const Panel& panel, const Box& window, const Scene<2>& scene,
               const std::vector<Wall<2>>& walls) {
  const auto chain = [&](const std::vector<Vec<2>>& points, const Stroke& stroke,
                         const std::vector<double>& dashes = {}) {
    Polyline line{{}, stroke, dashes};
    for (const Vec<2>& p : points) line.points.push_back(panel.point(p));
    list.add(line);
  };
  const auto region = [&](const Region<2>& r) {
    chain({r.low, {r.high[0], r.low[1]}, r.high, {r.low[0], r.high[1]}, r.low},
          {style::kFaint, style::kThin}, kDashes);
  };
  for (const auto& inlet : scene.inlets) region(inlet.region);
  for (const auto& outlet : scene.outlets) region(outlet.region);
  for (const Wall<2>& wall : walls) {
    if (wall.gone) continue;
    if (std::holds_alternative<HalfSpace<2>>(wall.shape)) {
      if (const auto part = visible_part(wall, window, walls)) {
        chain({(*part)[0], (*part)[1]}, style::kWallLine);
      }
      continue;
    }
    // Facets that follow each other are one line.
    std::vector<Vec<2>> points;
    for (const std::vector<Vec<2>>& facet : facets_of(wall, {})) {
      if (!points.empty() && points.back() != facet.front()) {
        chain(points, style::kWallLine);
        points.clear();
      }
      if (points.empty()) points.push_back(facet.front());
      points.push_back(facet.back());
    }
    chain(points, style::kWallLine);
  }
}

// ---- What lies in the plane ---------------------------------------------------------------------

void add_forces(DisplayList& list, const Panel& panel, const Snapshot<2>& snapshot,
                const PictureScale<2>& scale) {
  std::vector<ContactRecord<2>> contacts = *snapshot.contacts;
  // Strong chains lie on top of weak ones.
  std::stable_sort(contacts.begin(), contacts.end(), [](const auto& a, const auto& b) {
    return a.force.squaredNorm() < b.force.squaredNorm();
  });
  const Frame<2>& frame = snapshot.frame;
  for (const ContactRecord<2>& c : contacts) {
    const Vec<2> from = frame.position.col(c.i);
    const double width = scale.thickest() * std::min(c.force.norm() / scale.strongest, 1.0);
    // The round end of a line to a wall stays in front of it.
    const double arm = std::max(frame.radius[c.i] - c.overlap - 0.5 * width, 0.0);
    const Vec<2> to = c.j >= 0 ? Vec<2>(frame.position.col(c.j)) : Vec<2>(from - arm * c.normal);
    list.add(Segment{panel.point(from), panel.point(to), {style::kContact, panel.length(width)}});
  }
}

void add_plane(DisplayList& list, const Panel& panel, const Box& window, const Scene<2>& scene,
               const Snapshot<2>& snapshot, const PictureWish& wish, const PictureScale<2>& scale) {
  const Frame<2>& frame = snapshot.frame;
  const auto n = frame.position.cols();
  list.add(PushClip{panel.box()});
  Triangulation<2> triangulation;
  const bool geometry = wish.cells || wish.edges || wish.skins;
  if (geometry && n > 0) {
    triangulation.build(frame.position, frame.radius.array().square().matrix());
  }
  std::vector<std::vector<Vec<2>>> cells;
  if (wish.cells && n > 0) cells = cells_on_page(panel, triangulation);
  for (const auto& cell : cells) list.add(Polygon{.corners = cell, .fill = style::kCell});
  if (wish.grains) {
    const std::vector<Colour> colours = grain_colours(snapshot, wish, scale);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double radius = panel.length(frame.radius[i]);
      Disc disc{panel.point(frame.position.col(i)), radius, colours[static_cast<std::size_t>(i)]};
      if (radius > kThinGrain) {
        const double width = std::min(0.12 * radius, style::kMedium);
        disc.outline = {mix(disc.fill, style::kInk, wish.forces ? 0.25 : 0.6), width};
      }
      list.add(disc);
    }
  }
  if (wish.skins && n > 0) {
    Eigen::VectorXd skin = frame.radius;
    triangulation.for_each_edge([&](int i, int j) {
      const double fair = fair_skin(frame.radius[i], frame.radius[j],
                                    (frame.position.col(i) - frame.position.col(j)).squaredNorm());
      skin[i] = std::min(skin[i], fair);
      skin[j] = std::min(skin[j], fair);
    });
    for (Eigen::Index i = 0; i < n; ++i) {
      list.add(Disc{.centre = panel.point(frame.position.col(i)),
                    .radius = panel.length(frame.radius[i] + skin[i]),
                    .outline = {style::kEdgeNew, style::kThin}});
    }
  }
  for (const auto& cell : cells) list.add(Polygon{.corners = cell, .outline = style::kCellLine});
  if (wish.edges && n > 0) {
    triangulation.for_each_edge([&](int i, int j) {
      list.add(Segment{panel.point(frame.position.col(i)), panel.point(frame.position.col(j)),
                       style::kEdgeLine});
    });
  }
  if (wish.forces) add_forces(list, panel, snapshot, scale);
  if (wish.walls) add_walls(list, panel, window, scene, snapshot.walls);
  list.add(PopClip{});
}

// ---- The page -----------------------------------------------------------------------------------

/// A round length of about a fifth of a width [m], and its name.
std::pair<double, std::string> round_length(double width) {
  const double about = width / 5;
  const double unit = std::pow(10, std::floor(std::log10(about)));
  const double length = about >= 5 * unit ? 5 * unit : about >= 2 * unit ? 2 * unit : unit;
  const auto text = [&](double factor, const std::string& name) {
    return std::pair(length, rounded(std::round(length * factor * 1e6) / 1e6, 3) + " " + name);
  };
  if (length > 0.99 && length < 1000) return text(1, "m");
  if (length >= 1000) return text(1e-3, "km");
  if (length > 0.0099) return text(100, "cm");
  if (length > 0.00099) return text(1000, "mm");
  return text(1e6, "$\\mu$m");
}

double legend_width(const std::vector<std::string>& names) {
  double widest = 0;
  for (const std::string& name : names) {
    widest = std::max(widest, text_extents(label_text(name), style::kSmallText).advance);
  }
  return widest + 16;
}

template <int Dim>
void add_scale_of_colours(DisplayList& list, const Vec<2>& corner, double height,
                          const PictureScale<Dim>& scale) {
  if (has_bar(scale.colour)) {
    const Quantity quantity = quantity_of(scale.colour);
    const double largest = std::max(std::abs(scale.low), std::abs(scale.high));
    const ReadableUnit unit = readable_unit(quantity.unit, largest);
    const double tall = std::min(height - 16, 150.0);
    const Box bar{corner - Vec<2>(0, 14 + tall), corner + Vec<2>(kBarWidth, -14)};
    const bool both = scale.colour == ColourBy::spin && Dim == 2;
    add_colour_bar(list, bar, both ? ColourMap::blue_red : ColourMap::viridis,
                   unit.factor * scale.low, unit.factor * scale.high,
                   quantity.name + (unit.name.empty() ? "" : " [" + unit.name + "]"));
    if (scale.cut_off) {
      list.add(Label{.text = "some lie above",
                     .at = bar.low - Vec<2>(0, 4),
                     .size = style::kSmallText,
                     .colour = style::kInk,
                     .along = Along::top});
    }
    return;
  }
  double y = corner[1] - 4;
  for (std::size_t k = 0; k < scale.names.size(); ++k) {
    list.add(Disc{.centre = {corner[0] + 4, y},
                  .radius = 4,
                  .fill = mix(category(static_cast<int>(k)), style::kPaper, 0.2),
                  .outline = {style::kInk, style::kHairline}});
    list.add(Label{.text = label_text(scale.names[k]),
                   .at = {corner[0] + 12, y},
                   .size = style::kSmallText,
                   .colour = style::kInk,
                   .along = Along::middle});
    y -= 12;
  }
}

/// Arms along the axes of the world, as they lie on the page.
void add_axes(DisplayList& list, const Vec<2>& at, const Camera& camera) {
  const Eigen::Matrix3d page = page_axes(camera);
  for (int d = 0; d < 3; ++d) {
    const Vec<2> arm = page.block<2, 1>(0, d);
    if (arm.norm() < 0.15) continue;
    add_arrow(list, at, at + 12 * arm, {style::kInk, style::kThin});
    list.add(Label{.text = std::string("$") + "xyz"[d] + "$",
                   .at = at + 12 * arm + 4.5 * arm.normalized(),
                   .size = style::kSmallText,
                   .colour = style::kInk,
                   .across = Across::centre,
                   .along = Along::middle});
  }
}

std::string time_text(double time) {
  return "$t$ = " + (time == 0 ? std::string("0") : fixed(time, time < 10 ? 3 : 2)) + " s";
}

}  // namespace

template <int Dim>
void PictureScale<Dim>::extend(const PictureScale& other) {
  window.extend(other.window);
  if (colour == ColourBy::plain) {
    colour = other.colour, low = other.low, high = other.high;
  } else if (other.colour != ColourBy::plain) {
    low = std::min(low, other.low), high = std::max(high, other.high);
  }
  cut_off = cut_off || other.cut_off;
  for (const std::string& name : other.names) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  strongest = std::max(strongest, other.strongest);
  mean_radius = std::max(mean_radius, other.mean_radius);
}

template <int Dim>
PictureScale<Dim> scale_of(const Scene<Dim>& scene, const Snapshot<Dim>& snapshot,
                           const PictureWish& wish) {
  const Frame<Dim>& frame = snapshot.frame;
  PictureScale<Dim> scale;
  scale.window = window_of(scene, snapshot, wish.walls);
  if (frame.id.empty()) return scale;
  scale.mean_radius = frame.radius.mean();
  scale.colour = wish.colour               ? *wish.colour
                 : wish.forces && Dim == 2 ? ColourBy::plain
                                           : default_colour(scene, snapshot);
  need(scale.colour != ColourBy::spin || frame.spin,
       "--colour spin: grains without friction do not turn");
  if (wish.forces) scale.strongest = force_ceiling<Dim>(*snapshot.contacts);
  if (!(scale.strongest > 0)) scale.strongest = 1;
  if (scale.colour == ColourBy::material || scale.colour == ColourBy::group) {
    for (const std::string& name : categories_of(scene, snapshot, scale.colour)) {
      if (std::find(scale.names.begin(), scale.names.end(), name) == scale.names.end()) {
        scale.names.push_back(name);
      }
    }
    if (scale.colour == ColourBy::material) {
      // In the scene's order, so that all pictures of a run have the same colours.
      scale.names.clear();
      for (const Material& m : scene.materials) {
        if (m.density > 0) scale.names.push_back(m.name);
      }
    } else {
      std::sort(scale.names.begin(), scale.names.end());
    }
  }
  if (!has_bar(scale.colour)) return scale;
  std::vector<double> values = values_of(snapshot, scale.colour);
  const bool both = scale.colour == ColourBy::spin && Dim == 2;
  if (both) {
    for (double& v : values) v = std::abs(v);
  }
  std::sort(values.begin(), values.end());
  const auto many = static_cast<std::size_t>(0.995 * static_cast<double>(values.size() - 1));
  scale.high = values.back();
  // A few that are far above all others would make these all alike.
  if (scale.colour != ColourBy::coordination && values.back() > 2 * values[many] &&
      values[many] > 0) {
    scale.high = values[many];
    scale.cut_off = true;
  }
  const bool from_zero = scale.colour == ColourBy::speed || scale.colour == ColourBy::force ||
                         scale.colour == ColourBy::coordination || scale.colour == ColourBy::spin;
  scale.low = both ? -scale.high : from_zero ? 0 : values.front();
  if (!(scale.low < scale.high)) {
    const double air = scale.high == 0 ? 1 : 0.5 * std::abs(scale.high);
    scale.low = both ? -air : from_zero ? 0 : scale.low - air;
    scale.high += air;
  }
  return scale;
}

template <int Dim>
std::vector<Colour> grain_colours(const Snapshot<Dim>& snapshot, const PictureWish& wish,
                                  const PictureScale<Dim>& scale) {
  const std::size_t n = snapshot.frame.id.size();
  std::vector<Colour> colours(n, wish.forces ? style::kGrainPale : style::kGrain);
  if (has_bar(scale.colour)) {
    const std::vector<double> values = values_of(snapshot, scale.colour);
    const bool both = scale.colour == ColourBy::spin && Dim == 2;
    for (std::size_t k = 0; k < n; ++k) {
      colours[k] = colour(both ? ColourMap::blue_red : ColourMap::viridis,
                          (values[k] - scale.low) / (scale.high - scale.low));
    }
  } else if (!scale.names.empty()) {
    for (std::size_t k = 0; k < n; ++k) {
      int index = snapshot.frame.material[k];
      if (scale.colour == ColourBy::group) {
        const auto found = std::find(scale.names.begin(), scale.names.end(), snapshot.group[k]);
        index = static_cast<int>(found - scale.names.begin());
      }
      colours[k] = mix(category(index), style::kPaper, 0.2);
    }
  }
  return colours;
}

Vec<3> line_of_sight(const Vec<2>& view) {
  return {-std::cos(view[1]) * std::sin(view[0]), std::cos(view[1]) * std::cos(view[0]),
          -std::sin(view[1])};
}

template <int Dim>
PicturePage picture_of(const Scene<Dim>& scene, const Snapshot<Dim>& snapshot,
                       const PictureWish& wish, const PictureScale<Dim>& scale) {
  // The window as it lies on the page, with some air.
  Vec<2> world;
  Camera camera;
  if constexpr (Dim == 2) {
    world = scale.window.sizes();
    world += Vec<2>::Constant(0.03 * world.maxCoeff());
  } else {
    const Vec<3> sight = line_of_sight(wish.view);
    const Vec<3> up = std::abs(sight[2]) > 0.999 ? Vec<3>(-std::sin(wish.view[0]) * -sight[2],
                                                          std::cos(wish.view[0]) * -sight[2], 0)
                                                 : Vec<3>(0, 0, 1);
    camera = camera_framing({scale.window.min(), scale.window.max()}, sight, up, 1, 0, 0);
    const Eigen::Matrix3d page = page_axes(camera);
    world = (page.cwiseAbs() * scale.window.sizes()).template head<2>();
    world += Vec<2>::Constant(0.04 * world.maxCoeff());
  }

  const bool bar = has_bar(scale.colour);
  const double legend = bar ? 62 : scale.names.empty() ? 0 : legend_width(scale.names) + 8;
  const Vec<2> around(2 * kEdge + legend, 2 * kEdge + kTop + kBottom);
  Vec<2> inner = world * std::min(kFitWidth / world[0], kFitHeight / world[1]);
  // A narrow one needs room for what stands above, beneath and beside it.
  inner = inner.cwiseMax(Vec<2>(130, 110));
  PicturePage page;
  if (wish.size) {
    const Vec<2> wanted((*wish.size)[0], (*wish.size)[1]);
    const Vec<2> usual = inner + around;
    const double points = std::sqrt(usual[0] * usual[1] / (wanted[0] * wanted[1]));
    const Vec<2> size = (points * wanted).cwiseMax(around + Vec<2>(20, 20));
    inner = size - around;
    page.dpi = 72 * wanted[0] / size[0];
  }
  DisplayList& list = page.list;
  list.width = inner[0] + around[0];
  list.height = inner[1] + around[1];
  list.title = scene.title;
  const Vec<2> low(kEdge, kEdge + kBottom);
  const Box area{low, low + inner};

  // The world fills the whole area, so that walls without an end reach its border.
  const double metres = (world.array() / inner.array()).maxCoeff();  // in a point
  const Vec<2> half = 0.5 * metres * inner;
  double width = 2 * half[0];
  if constexpr (Dim == 2) {
    const Vec<2> middle = scale.window.center();
    const Box window{middle - half, middle + half};
    const Panel panel(area, window);
    add_plane(list, panel, window, scene, snapshot, wish, scale);
    width = window.size()[0];
  } else {
    Scene3 space = space_of(scene, snapshot, wish, scale);
    camera.height = 2 * half[1];
    space.camera = camera;
    if (wish.view[1] < 0) space.lights = over_the_shoulder(camera);
    list.add(paint_scene3(space, area, page.dpi));
    add_axes(list, {kEdge + 14, kEdge + 8}, camera);
  }

  list.add(Label{.text = time_text(snapshot.frame.time),
                 .at = {kEdge, list.height - kEdge},
                 .size = style::kText,
                 .colour = style::kInk,
                 .along = Along::top});
  const auto [length, name] = round_length(std::min(width, world[0]));
  const Panel lengths(area, {-half, half});
  const Vec<2> bar_at(kEdge + (Dim == 3 ? 42 : 3), kEdge + 6);
  add_scale_bar(list, bar_at, lengths, length, name);
  if (wish.forces && snapshot.contacts && !snapshot.contacts->empty()) {
    const ReadableUnit unit = readable_unit("N", scale.strongest);
    const std::vector<double> values = legend_forces(unit.factor * scale.strongest);
    const double per_unit = lengths.length(scale.thickest()) / (unit.factor * scale.strongest);
    const double left = bar_at[0] + lengths.length(length) + 24;
    add_width_legend(list, {left, kEdge + 13}, values, per_unit, unit.name);
  }
  if (wish.grains) {
    add_scale_of_colours(list, {area.high[0] + 10, list.height - kEdge}, inner[1] + kTop, scale);
  }
  return page;
}

template void PictureScale<2>::extend(const PictureScale<2>&);
template void PictureScale<3>::extend(const PictureScale<3>&);
template PictureScale<2> scale_of<2>(const Scene<2>&, const Snapshot<2>&, const PictureWish&);
template PictureScale<3> scale_of<3>(const Scene<3>&, const Snapshot<3>&, const PictureWish&);
template std::vector<Colour> grain_colours<2>(const Snapshot<2>&, const PictureWish&,
                                              const PictureScale<2>&);
template std::vector<Colour> grain_colours<3>(const Snapshot<3>&, const PictureWish&,
                                              const PictureScale<3>&);
template PicturePage picture_of<2>(const Scene<2>&, const Snapshot<2>&, const PictureWish&,
                                   const PictureScale<2>&);
template PicturePage picture_of<3>(const Scene<3>&, const Snapshot<3>&, const PictureWish&,
                                   const PictureScale<3>&);

}  // namespace lagrain::figures
