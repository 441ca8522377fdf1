// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/numbers.hpp>
#include <lagrain/scene.hpp>

#include "scene_keys.hpp"

#include <cmath>
#include <string>
#include <type_traits>

namespace lagrain {
namespace {

using detail::Key;
using detail::text_of;
namespace keys = detail::keys;

/// A number that TOML reads as the same one: a long row of digits would be too large an integer,
/// and an integer has no negative zero.
std::string in_toml(double value) {
  std::string text = shortest(value);
  const bool fails_as_integer = std::abs(value) >= 1e15 || (value == 0 && std::signbit(value));
  if (fails_as_integer && text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}
std::string in_toml(int value) { return std::to_string(value); }
std::string in_toml(bool value) { return value ? "true" : "false"; }
std::string in_toml(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      constexpr std::string_view kHex = "0123456789ABCDEF";
      const auto code = static_cast<unsigned char>(c);
      out += "\\u00";
      out += kHex[code / 16];
      out += kHex[code % 16];
    } else {
      out += c;
    }
  }
  return out + "\"";
}
/// Any list of numbers.
template <class V>
requires(!std::is_convertible_v<V, std::string_view> && !std::is_arithmetic_v<V>) std::string
    in_toml(const V& v) {
  std::string text = "[";
  for (const double x : v) {
    if (text.size() > 1) text += ", ";
    text += in_toml(x);
  }
  return text += ']';
}

template <int N>
std::string in_toml(const std::vector<Eigen::Matrix<double, N, 1>>& points) {
  std::string text;
  for (const auto& p : points) text += (text.empty() ? "" : ", ") + in_toml(p);
  return "[" + text + "]";
}

/// The text of a scene, line by line.
class Lines {
 public:
  void table(const std::string& header) { text_ += "\n" + header + "\n"; }
  /// key = value  # unit
  template <class Value>
  void add(const Key& key, const Value& value) {
    as_it_is(key, in_toml(value), to_string(key.measure.unit));
  }
  /// A value that is TOML already.
  void as_it_is(const Key& key, const std::string& value, const std::string& remark = {}) {
    text_ += std::string(key.name) + " = " + value;
    if (!remark.empty()) text_ += "  # " + remark;
    text_ += "\n";
  }
  std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

/// A table within a line: { key = value, ... }.
class Inline {
 public:
  template <class Value>
  Inline& add(const Key& key, const Value& value) {
    return as_it_is(key, in_toml(value));
  }
  /// A value that is TOML already.
  Inline& as_it_is(const Key& key, const std::string& value) {
    text_ += (text_.empty() ? "" : ", ") + std::string(key.name) + " = " + value;
    return *this;
  }
  bool empty() const { return text_.empty(); }
  std::string text() const { return "{ " + text_ + " }"; }

 private:
  std::string text_;
};

/// Picks what to do by type; what no case knows does not compile.
template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

template <int Dim>
class Writer {
 public:
  explicit Writer(const Scene<Dim>& scene) : scene_(scene) {}

  std::string write() {
    write_top();
    write_drag();
    out_.table("[" + std::string(keys::kLaw.name) + "]");
    write_law(scene_.law);
    for (const Material& m : scene_.materials) {
      out_.table("[" + std::string(keys::kMaterials.name) + "." + in_toml(m.name) + "]");
      if (m.density > 0) out_.add(keys::kMaterialDensity, m.density);
    }
    for (const PairLaw& pair : scene_.pairs) {
      one_of(keys::kPair);
      out_.as_it_is(keys::kBetween, "[" + in_toml(material_name(pair.a)) + ", " +
                                        in_toml(material_name(pair.b)) + "]");
      if (pair.touch) {
        write_law(pair.law);
      } else {
        out_.add(keys::kTouch, false);
      }
    }
    if (scene_.start) {
      out_.table("[" + std::string(keys::kStart.name) + "]");
      out_.add(keys::kRun, std::string_view(scene_.start->run.string()));
      out_.add(keys::kInstant, detail::kLastState);
    }
    for (const Fill<Dim>& fill : scene_.fills) write_fill(fill);
    for (const PlacedGrain<Dim>& grain : scene_.grains) write_grain(grain);
    for (const GrainFile<Dim>& grains : scene_.grain_files) write_grain_file(grains);
    for (const Inlet<Dim>& inlet : scene_.inlets) write_inlet(inlet);
    for (const Outlet<Dim>& outlet : scene_.outlets) write_outlet(outlet);
    if (scene_.domain) {
      out_.table("[" + std::string(keys::kDomain.name) + "]");
      write_corners(*scene_.domain);
    }
    for (const Wall<Dim>& wall : scene_.walls) write_wall(wall);
    for (const MeasuredRegion<Dim>& measure : scene_.measures) write_measure(measure);
    for (const MeasuredPlane<Dim>& plane : scene_.planes) write_plane(plane);
    write_output();
    return std::move(out_).text();
  }

 private:
  void one_of(const Key& key) { out_.table("[[" + std::string(key.name) + "]]"); }
  std::string_view material_name(int material) const {
    return scene_.materials[static_cast<std::size_t>(material)].name;
  }

  void write_top() {
    out_.add(keys::kTitle, std::string_view(scene_.title));
    out_.add(keys::kDimension, Dim);
    out_.as_it_is(keys::kSeed, std::to_string(scene_.seed));
    out_.add(keys::kDuration, scene_.duration);
    if (scene_.time_step.seconds > 0) {
      out_.add(keys::kTimeStep, scene_.time_step.seconds);
    } else {
      out_.as_it_is(keys::kTimeStep,
                    "\"" + in_toml(scene_.time_step.fraction_of_contact) + " contact\"");
    }
    write_gravity();
    if (Dim == 2) out_.add(keys::kDepth, scene_.depth);
    out_.add(keys::kNormalLaw, description_of(scene_.normal).word);
    out_.add(keys::kFrictionLaw, description_of(scene_.friction).word);
    out_.add(keys::kIntegrator, name_of(scene_.integrator));
    out_.add(keys::kNeighbourhood, name_of(scene_.neighbourhood));
    out_.add(keys::kLargestOverlap, scene_.largest_overlap);
    out_.add(keys::kLargestInitialOverlap, scene_.largest_initial_overlap);
    out_.add(keys::kAudit, scene_.audit);
    if (scene_.audit) out_.add(keys::kAuditEvery, scene_.audit_every);
  }

  void write_gravity() {
    std::visit(Overloaded{[&](const SteadyGravity&) { out_.add(keys::kGravity, scene_.gravity); },
                          [&](const TurningGravity<Dim>& turning) {
                            Inline gravity;
                            gravity.add(keys::kGravityValue, scene_.gravity);
                            if constexpr (Dim == 3) gravity.add(keys::kAxis, turning.axis);
                            gravity.add(keys::kTurningRate, turning.rate);
                            gravity.add(keys::kStart, turning.start);
                            if (std::isfinite(turning.stop)) gravity.add(keys::kStop, turning.stop);
                            out_.as_it_is(keys::kGravity, gravity.text());
                          },
                          [&](const GravityTable<Dim>& table) {
                            out_.as_it_is(keys::kGravity,
                                          Inline{}
                                              .add(keys::kTimes, table.times)
                                              .add(keys::kGravityValues, table.gravity)
                                              .text());
                          }},
               scene_.gravity_course);
  }

  void write_drag() {
    if (!scene_.drag) return;
    out_.table("[" + std::string(keys::kDrag.name) + "]");
    if (Dim == 3) out_.add(keys::kViscosity, scene_.drag->viscosity);
    out_.add(keys::kDragRate, scene_.drag->rate);
    out_.add(keys::kVelocity, scene_.drag->flow);
  }

  void write_law(const LawNumbers& law) {
    for (const auto& keys :
         {description_of(scene_.normal).keys, description_of(scene_.friction).keys}) {
      for (const LawKey& key : keys) {
        if (Dim == 3 || !key.in_space_only) out_.add(detail::key_of(key), law.*key.number);
      }
    }
  }

  void write_fill(const Fill<Dim>& fill) {
    one_of(keys::kFill);
    out_.add(keys::kName, std::string_view(fill.name));
    out_.add(keys::kMaterial, material_name(fill.material));
    if (fill.count) out_.add(keys::kCount, *fill.count);
    write_radius(fill.radius);
    write_region(fill.region);
    out_.add(keys::kArrangement, text_of(detail::kArrangementWords, fill.arrangement));
    if (fill.pinned) {
      out_.add(keys::kPinned, true);
      return;
    }
    write_velocity(fill);
    write_spin(fill.spin);
    if (fill.driven) out_.add(keys::kDriven, true);
  }

  void write_inlet(const Inlet<Dim>& inlet) {
    one_of(keys::kInlet);
    out_.add(keys::kName, std::string_view(inlet.name));
    out_.add(keys::kMaterial, material_name(inlet.material));
    write_radius(inlet.radius);
    write_region(inlet.region);
    out_.add(keys::kRate, inlet.rate);
    out_.add(keys::kStart, inlet.start);
    if (std::isfinite(inlet.stop)) out_.add(keys::kStop, inlet.stop);
    if (inlet.count) out_.add(keys::kCount, *inlet.count);
    write_velocity(inlet);
  }

  void write_outlet(const Outlet<Dim>& outlet) {
    one_of(keys::kOutlet);
    out_.add(keys::kName, std::string_view(outlet.name));
    write_corners(outlet.region);
  }

  void write_corners(const Region<Dim>& region) {
    out_.add(keys::kLow, region.low);
    out_.add(keys::kHigh, region.high);
  }

  void write_region(const Region<Dim>& region) {
    out_.as_it_is(keys::kRegion,
                  Inline{}.add(keys::kLow, region.low).add(keys::kHigh, region.high).text());
  }

  /// Of a fill or an inlet.
  template <class Source>
  void write_velocity(const Source& source) {
    if (source.random_speed > 0) {
      out_.as_it_is(keys::kVelocity, Inline{}.add(keys::kRandomSpeed, source.random_speed).text());
    } else {
      out_.add(keys::kVelocity, source.velocity);
    }
  }

  void write_radius(const RadiusLaw& radius_law) {
    std::visit(Overloaded{[&](double radius) { out_.add(keys::kRadius, radius); },
                          [&](const UniformRadius& law) {
                            out_.as_it_is(keys::kRadius,
                                          Inline{}
                                              .add(keys::kUniform, std::array{law.low, law.high})
                                              .add(keys::kBy, text_of(detail::kShareWords, law.by))
                                              .text());
                          },
                          [&](const ListedRadius& law) {
                            out_.as_it_is(keys::kRadius,
                                          Inline{}
                                              .add(keys::kValues, law.values)
                                              .add(keys::kWeights, law.weights)
                                              .add(keys::kBy, text_of(detail::kShareWords, law.by))
                                              .text());
                          },
                          [&](const SieveCurve& law) {
                            out_.as_it_is(keys::kRadius, Inline{}
                                                             .add(keys::kSieves, law.openings)
                                                             .add(keys::kPassing, law.passing)
                                                             .text());
                          }},
               radius_law);
  }

  void write_grain(const PlacedGrain<Dim>& grain) {
    one_of(keys::kGrain);
    out_.add(keys::kPosition, grain.position);
    out_.add(keys::kRadius, grain.radius);
    out_.add(keys::kMaterial, material_name(grain.material));
    if (grain.pinned) {
      out_.add(keys::kPinned, true);
      return;
    }
    out_.add(keys::kVelocity, grain.velocity);
    write_spin(grain.spin);
    if (grain.driven) out_.add(keys::kDriven, true);
  }

  void write_spin(const SpinVec<Dim>& spin) {
    if (scene_.friction == FrictionModel::none) return;
    if constexpr (Dim == 2) {
      out_.add(keys::kSpin, spin[0]);
    } else {
      out_.add(keys::kSpin, spin);
    }
  }

  void write_grain_file(const GrainFile<Dim>& grains) {
    one_of(keys::kGrains);
    out_.add(keys::kFile, std::string_view(grains.file.string()));
    if (grains.material) out_.add(keys::kMaterial, material_name(*grains.material));
    out_.add(keys::kShift, grains.shift);
    out_.add(keys::kAtRest, grains.at_rest);
    out_.add(keys::kPinned, grains.pinned);
    if (grains.driven) out_.add(keys::kDriven, true);
  }

  void write_wall(const Wall<Dim>& wall) {
    one_of(keys::kWall);
    out_.add(keys::kName, std::string_view(wall.name));
    out_.add(keys::kMaterial, material_name(wall.material));
    std::visit(Overloaded{[&](const HalfSpace<Dim>& plane) {
                            out_.add(keys::kPoint, wall.home);
                            out_.add(keys::kNormal, plane.normal);
                          },
                          [&](const Cylinder<Dim>& round) {
                            out_.add(keys::kPoint, wall.home);
                            if (Dim == 3) out_.add(keys::kAxis, round.axis);
                            out_.add(keys::kRadius, round.radius);
                          },
                          [&](const Sheet<Dim>& sheet) { write_sheet(wall.home, sheet); }},
               wall.shape);
    if (wall.front_only) out_.add(keys::kSolid, text_of(detail::kSolidWords, wall.front_only));
    write_motion(wall);
    write_turning(wall);
    if (wall.runs()) out_.add(keys::kBelt, wall.belt);
    if (std::isfinite(wall.until)) out_.add(keys::kUntil, wall.until);
  }

  /// Places are written relative to the wall's point, as they are kept: a sum would be rounded.
  void write_sheet(const Vec<Dim>& home, const Sheet<Dim>& sheet) {
    const auto lists = [&] {
      std::string text;
      for (const WallPiece<Dim>& piece : sheet.pieces()) {
        const auto corners = std::visit([](const auto& p) { return p.corners(); }, piece);
        text += (text.empty() ? "" : ", ") + in_toml(corners);
      }
      return "[" + text + "]";
    };
    const bool one = sheet.pieces().size() == 1;
    const WallPiece<Dim>& first = sheet.piece(0);
    if constexpr (Dim == 2) {
      if (const auto* arc = std::get_if<Arc>(&first)) {
        out_.add(keys::kPoint, home);
        out_.add(keys::kFrom, arc->from());
        out_.add(keys::kThrough, arc->through());
        out_.add(keys::kTo, arc->to());
      } else if (const auto& segment = std::get<WallSegment>(first);
                 one && segment.from().isZero(0)) {
        out_.add(keys::kFrom, home);
        out_.add(keys::kAlong, segment.along());
      } else {
        out_.add(keys::kPoint, home);
        out_.as_it_is(keys::kLines, lists(), "m");
      }
    } else {
      out_.add(keys::kPoint, home);
      if (const auto* frustum = std::get_if<Frustum>(&first)) {
        out_.add(keys::kAxis, frustum->axis);
        if (frustum->height > 0) out_.add(keys::kHeight, frustum->height);
        out_.add(keys::kRadii, std::array{frustum->low_radius, frustum->high_radius});
      } else if (one) {
        out_.as_it_is(keys::kCorners, in_toml(std::get<Plate>(first).corners()), "m");
      } else {
        out_.as_it_is(keys::kPlates, lists(), "m");
      }
    }
  }

  void write_motion(const Wall<Dim>& wall) {
    Inline motion;
    const auto type = [&](detail::MotionType t) {
      motion.add(keys::kType, text_of(detail::kMotionWords, t));
    };
    const auto times = [&](const auto& m) {
      motion.add(keys::kStart, m.start);
      if (std::isfinite(m.stop)) motion.add(keys::kStop, m.stop);
    };
    std::visit(Overloaded{[](const Fixed&) {},
                          [&](const Steady<Dim>& m) {
                            type(detail::MotionType::steady);
                            motion.add(keys::kVelocity, m.velocity);
                            times(m);
                          },
                          [&](const Shake<Dim>& m) {
                            type(detail::MotionType::shake);
                            motion.add(keys::kAmplitude, m.amplitude);
                            motion.add(keys::kFrequency, m.frequency);
                            times(m);
                          },
                          [&](const Path<Dim>& m) {
                            type(detail::MotionType::path);
                            motion.add(keys::kTimes, m.times);
                            motion.add(keys::kShifts, m.shifts);
                          },
                          [&](const Piston<Dim>& m) {
                            type(detail::MotionType::piston);
                            motion.add(keys::kPistonMass, m.mass);
                            if (m.pressure) {
                              write_pressure(motion, *m.pressure);
                            } else {
                              motion.add(keys::kLoad, m.load);
                            }
                            motion.add(keys::kStart, m.start);
                          }},
               wall.motion);
    if (!motion.empty()) out_.as_it_is(keys::kMotion, motion.text());
  }

  void write_pressure(Inline& motion, const Pressure<Dim>& pressure) {
    std::string names;
    for (const auto& pair : pressure.between) {
      for (const int wall : pair) {
        names += (names.empty() ? "" : ", ") +
                 in_toml(std::string_view(scene_.walls[static_cast<std::size_t>(wall)].name));
      }
    }
    motion.add(keys::kPressure, pressure.value);
    motion.as_it_is(keys::kBetween, "[" + names + "]");
  }

  void write_turning(const Wall<Dim>& wall) {
    Inline turning;
    const auto write = [&](detail::TurningType type, const auto& m, auto&& numbers) {
      turning.add(keys::kType, text_of(detail::kTurningWords, type));
      if constexpr (Dim == 3) turning.add(keys::kAxis, m.axis);
      turning.add(keys::kAbout, m.about);
      numbers();
      turning.add(keys::kStart, m.start);
      if (std::isfinite(m.stop)) turning.add(keys::kStop, m.stop);
    };
    std::visit(Overloaded{[](const Upright&) {},
                          [&](const Turn<Dim>& m) {
                            write(detail::TurningType::steady, m,
                                  [&] { turning.add(keys::kTurningRate, m.rate); });
                          },
                          [&](const Swing<Dim>& m) {
                            write(detail::TurningType::swing, m, [&] {
                              turning.add(keys::kAngle, m.amplitude);
                              turning.add(keys::kFrequency, m.frequency);
                            });
                          }},
               wall.turning);
    if (!turning.empty()) out_.as_it_is(keys::kTurning, turning.text());
  }

  void write_measure(const MeasuredRegion<Dim>& measure) {
    one_of(keys::kMeasure);
    out_.add(keys::kName, std::string_view(measure.name));
    write_region(measure.region);
    out_.add(keys::kSlices, measure.slices);
    out_.add(keys::kAxis,
             std::string_view("xyz").substr(static_cast<std::size_t>(measure.axis), 1));
  }

  void write_plane(const MeasuredPlane<Dim>& plane) {
    one_of(keys::kMeasure);
    out_.add(keys::kName, std::string_view(plane.name));
    out_.add(keys::kPoint, plane.point);
    out_.add(keys::kNormal, plane.normal);
    if (plane.region) write_region(*plane.region);
  }

  void write_output() {
    out_.table("[" + std::string(keys::kOutput.name) + "]");
    const OutputPlan& plan = scene_.output;
    if (plan.frames_every > 0) out_.add(keys::kFramesEvery, plan.frames_every);
    if (plan.series_every > 0) out_.add(keys::kSeriesEvery, plan.series_every);
    out_.add(keys::kContacts, plan.contacts);
    std::string formats;
    for (const OutputFormat format : plan.formats) {
      formats += (formats.empty() ? "" : ", ") + in_toml(text_of(detail::kFormatWords, format));
    }
    out_.as_it_is(keys::kFormats, "[" + formats + "]");
  }

  const Scene<Dim>& scene_;
  Lines out_;
};

}  // namespace

std::string_view name_of(NormalModel model) { return description_of(model).word; }
std::string_view name_of(FrictionModel model) { return description_of(model).word; }
std::string_view name_of(IntegratorModel model) { return text_of(detail::kIntegratorWords, model); }
std::string_view name_of(NeighbourhoodModel model) {
  return text_of(detail::kNeighbourhoodWords, model);
}

template <int Dim>
std::string to_toml(const Scene<Dim>& scene) {
  return Writer<Dim>(scene).write();
}

template std::string to_toml<2>(const Scene<2>&);
template std::string to_toml<3>(const Scene<3>&);

}  // namespace lagrain
