// SPDX-License-Identifier: GPL-3.0-or-later
#include "start.hpp"

#include <lagrain/checkpoint.hpp>
#include <lagrain/files.hpp>
#include <lagrain/numbers.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <system_error>
#include <utility>

namespace lagrain::detail {
namespace {

namespace fs = std::filesystem;

Checkpoint open(const StartState& start) {
  std::error_code ignored;
  if (!fs::is_regular_file(start.run, ignored)) return read_checkpoint(start.run);
  try {
    return {decode_checkpoint(read_file(start.run)), start.run, {}};
  } catch (const SceneError& error) {
    throw SceneError(start.run.string() + ": " + error.what());
  }
}

/// The place of the thing of a name in a list.
template <class Named>
std::optional<std::size_t> place_of(const std::string& name, const std::vector<Named>& list) {
  const auto found = std::find_if(list.begin(), list.end(),
                                  [&](const Named& thing) { return thing.name == name; });
  if (found == list.end()) return {};
  return static_cast<std::size_t>(found - list.begin());
}

/// Takes out of a checkpoint what a scene can start from.
template <int Dim>
class StartReader {
 public:
  StartReader(const Scene<Dim>& scene, const Checkpoint& checkpoint)
      : scene_(scene), state_(checkpoint.state), name_(checkpoint.file.string()) {
    std::int64_t dimension = 0;
    StateVisitor::restoring(state_).in("record")("dimension", dimension);
    if (dimension != Dim) {
      throw SceneError("it is of " + std::to_string(dimension) + " dimensions, the scene of " +
                       std::to_string(Dim));
    }
    before_ = parse_scene<Dim>(state_.get<std::string>("record/scene"), name_);
  }

  Start<Dim> read() {
    read_grains();
    start_.walls = scene_.walls;
    std::vector<std::string> pistons;
    for (Wall<Dim>& wall : start_.walls) {
      if (take_piston(wall)) pistons.push_back(wall.name);
    }
    const bool same_laws = scene_.normal == before_.normal && scene_.friction == before_.friction;
    if (same_laws && state_.values().count("run/memory/contacts/slot") > 0) read_memories();

    std::int64_t step = 0;
    StateVisitor::restoring(state_).in("run")("step", step);
    const double time = static_cast<double>(step) * before_.time_step.seconds;
    start_.origin = std::to_string(start_.grains.size()) + " grains of " + name_ + " at " +
                    rounded(time, 4) + " s";
    for (const std::string& piston : pistons) start_.origin += ", piston \"" + piston + "\"";
    const std::size_t recalled = start_.recalled.pairs.size() + start_.recalled.at_walls.size();
    if (recalled > 0) start_.origin += ", " + std::to_string(recalled) + " contacts that remember";
    if (!same_laws) start_.origin += ", under other laws: contacts remember nothing";
    return std::move(start_);
  }

 private:
  [[noreturn]] static void refuse() { throw SceneError("its grains do not fit together"); }

  void read_grains() {
    StateVisitor run = StateVisitor::restoring(state_).in("run");
    StateVisitor in = run.in("grains");
    std::vector<int> materials;
    std::vector<bool> held;
    Columns<Dim> position, velocity;
    Columns<kSpinDim<Dim>> spin;
    Eigen::VectorXd radius;
    in("number", number_);
    in("ids", start_.ids);
    in("position", position);
    in("velocity", velocity);
    in("radius", radius);
    run("materials", materials);
    run("held", held);
    const bool spins = state_.values().count("run/grains/omega") > 0;
    if (spins) in("omega", spin);

    const std::size_t n = number_.size();
    const auto count = static_cast<Eigen::Index>(n);
    if (position.cols() != count || velocity.cols() != count || radius.size() != count ||
        materials.size() != n || held.size() != n || (spins && spin.cols() != count) ||
        !(start_.ids.empty() || start_.ids.size() == n)) {
      refuse();
    }
    if (start_.ids.empty()) {
      start_.ids.resize(n);
      std::iota(start_.ids.begin(), start_.ids.end(), 0);
    }
    start_.grains.resize(n);
    std::vector<bool> seen(n, false);
    for (std::size_t slot = 0; slot < n; ++slot) {
      const auto i = static_cast<std::size_t>(number_[slot]);
      if (i >= n || seen[i]) refuse();
      seen[i] = true;
      const auto column = static_cast<Eigen::Index>(slot);
      PlacedGrain<Dim>& grain = start_.grains[i];
      grain.position = position.col(column);
      grain.velocity = velocity.col(column);
      if (spins) grain.spin = spin.col(column);
      grain.radius = radius[column];
      grain.material = material_of(materials[i]);
      const bool moves = !grain.velocity.isZero(0) || !grain.spin.isZero(0);
      grain.pinned = held[i] && !moves;
      grain.driven = held[i] && moves;
    }
  }

  int material_of(int before) const {
    if (static_cast<std::size_t>(before) >= before_.materials.size()) refuse();
    const std::string& name = before_.materials[static_cast<std::size_t>(before)].name;
    const auto place = place_of(name, scene_.materials);
    if (place) return static_cast<int>(*place);
    throw SceneError("it has grains of material \"" + name +
                     "\", which the scene does not name; add [materials." + name + "]");
  }

  /// A piston goes on from where it stood if the run had one of its name.
  /// @return whether it does
  bool take_piston(Wall<Dim>& wall) const {
    const auto place = place_of(wall.name, before_.walls);
    if (!place || !std::holds_alternative<Piston<Dim>>(wall.motion) ||
        !std::holds_alternative<Piston<Dim>>(before_.walls[*place].motion)) {
      return false;
    }
    StateVisitor in =
        StateVisitor::restoring(state_).in("run").in("walls").in(std::to_string(*place));
    in("point", wall.point);
    in("velocity", wall.velocity);
    return true;
  }

  /// @pre the laws are the same
  void read_memories() {
    StateVisitor in = StateVisitor::restoring(state_).in("run").in("memory");
    std::vector<int> first, second, piece;
    const auto number_of = [&](int slot) {
      if (slot < 0 || static_cast<std::size_t>(slot) >= number_.size()) refuse();
      return number_[static_cast<std::size_t>(slot)];
    };

    RecalledContacts& recalled = start_.recalled;
    StateVisitor contacts = in.in("contacts");
    contacts("slot", first);
    contacts("partner", second);
    recalled.memories = columns_of("run/memory/contacts/memory", first.size());
    if (second.size() != first.size()) refuse();
    for (std::size_t k = 0; k < first.size(); ++k) {
      recalled.pairs.push_back({number_of(first[k]), number_of(second[k])});
    }

    StateVisitor at_walls = in.in("wall_contacts");
    at_walls("slot", first);
    at_walls("wall", second);
    at_walls("piece", piece);
    const Eigen::MatrixXd all = columns_of("run/memory/wall_contacts/memory", first.size());
    if (second.size() != first.size() || piece.size() != first.size()) refuse();
    std::vector<Eigen::Index> kept;
    for (std::size_t k = 0; k < first.size(); ++k) {
      if (static_cast<std::size_t>(second[k]) >= before_.walls.size()) refuse();
      const auto wall =
          place_of(before_.walls[static_cast<std::size_t>(second[k])].name, scene_.walls);
      if (!wall || piece[k] < 0 || piece[k] >= scene_.walls[*wall].piece_count()) continue;
      recalled.at_walls.push_back({number_of(first[k]), static_cast<int>(*wall), piece[k]});
      kept.push_back(static_cast<Eigen::Index>(k));
    }
    recalled.wall_memories = all(Eigen::all, kept);
  }

  /// A table of the state, a row of which is a column of the matrix.
  Eigen::MatrixXd columns_of(const std::string& name, std::size_t count) const {
    const auto& table = state_.get<NumberTable<double>>(name);
    if (table.rows() != count) refuse();
    return Eigen::Map<const Eigen::MatrixXd>(table.numbers.data(),
                                             static_cast<Eigen::Index>(table.columns),
                                             static_cast<Eigen::Index>(count));
  }

  const Scene<Dim>& scene_;
  const State& state_;
  std::string name_;
  Scene<Dim> before_;        // of that run
  std::vector<int> number_;  // of the grain in each slot
  Start<Dim> start_;
};

}  // namespace

template <int Dim>
Start<Dim> read_start(const Scene<Dim>& scene) {
  const auto located = [&](const std::string& message) { return scene.error("start", message); };
  Checkpoint checkpoint;
  try {
    checkpoint = open(*scene.start);
  } catch (const SceneError& error) {
    throw located(error.what());
  }
  try {
    return StartReader<Dim>(scene, checkpoint).read();
  } catch (const SceneError& error) {
    throw located(checkpoint.file.string() + ": " + error.what());
  }
}

std::string start_bytes(const StartState& start) { return read_file(open(start).file); }

template Start<2> read_start<2>(const Scene<2>&);
template Start<3> read_start<3>(const Scene<3>&);

}  // namespace lagrain::detail
