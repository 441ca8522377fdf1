// SPDX-License-Identifier: GPL-3.0-or-later
#include "run_folder.hpp"

#include <lagrain/files.hpp>
#include <lagrain/format.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>
#include <utility>

namespace lagrain::figures {
namespace {

namespace fs = std::filesystem;

constexpr double kNever = std::numeric_limits<double>::infinity();

/// The text up to the end of its last row that is whole.
std::string whole_rows(std::string text) {
  text.resize(text.rfind('\n') + 1);
  return text;
}

std::vector<std::string> group_names(const auto& scene) {
  std::vector<std::string> names;
  for (const auto& fill : scene.fills) names.push_back(fill.name);
  for (const auto& inlet : scene.inlets) names.push_back(inlet.name);
  return names;
}

std::string group_name(const std::vector<std::string>& names, int group) {
  return group < 0 ? "others" : names[static_cast<std::size_t>(group)];
}

/// The place of an id in an increasing list; -1 if it is not there.
int place_of(const std::vector<int>& ids, std::int64_t id) {
  const auto found = std::lower_bound(ids.begin(), ids.end(), id);
  return found != ids.end() && *found == id ? static_cast<int>(found - ids.begin()) : -1;
}

}  // namespace

template <int Dim>
Snapshot<Dim> snapshot_of(const Run<Dim>& run) {
  Snapshot<Dim> snapshot;
  snapshot.source = "the state";
  snapshot.frame = Frame<Dim>::of(run);
  snapshot.walls = run.walls();
  const auto names = group_names(run.scene());
  for (const int group : run.groups()) snapshot.group.push_back(group_name(names, group));
  snapshot.contacts = run.contacts();
  return snapshot;
}

// ---- Files --------------------------------------------------------------------------------------

CsvFile::CsvFile(fs::path file)
    : file_(std::move(file)), text_(whole_rows(read_file(file_))), rows_(text_) {
  if (!rows_.next()) throw SceneError(file_.string() + ": empty; expected the names of columns");
  for (const std::string_view title : rows_.cells()) {
    const auto [name, unit] = name_and_unit(title);
    names_.emplace_back(name);
    units_.emplace_back(unit);
  }
}

std::optional<std::size_t> CsvFile::find(const std::string& name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names_.begin());
}

std::size_t CsvFile::column(const std::string& name) const {
  if (const auto place = find(name)) return *place;
  throw SceneError(file_.string() + ": no column \"" + name + "\"");
}

bool CsvFile::next() {
  if (!rows_.next()) return false;
  if (rows_.cells().size() != names_.size()) {
    fail(std::to_string(rows_.cells().size()) + " values, expected " +
         std::to_string(names_.size()));
  }
  return true;
}

double CsvFile::number(std::size_t column) const {
  const std::string_view cell = rows_.cells()[column];
  double value = std::numeric_limits<double>::quiet_NaN();
  if (cell.empty()) return value;
  const char* const end = cell.data() + cell.size();
  const auto [stop, failure] = std::from_chars(cell.data(), end, value);
  if (failure != std::errc{} || stop != end) fail(names_[column] + ": expected a number");
  return value;
}

std::int64_t CsvFile::whole(std::size_t column) const {
  const double value = number(column);
  constexpr double kMost = 1e15;  // beyond it doubles no longer hold all whole numbers
  if (!(std::abs(value) < kMost) || value != std::floor(value)) {
    fail(names_[column] + ": expected a whole number");
  }
  return static_cast<std::int64_t>(value);
}

void CsvFile::fail(const std::string& message) const {
  throw SceneError(file_.string() + ":" + std::to_string(rows_.line()) + ": " + message);
}

int dimension_of_run(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    throw SceneError(folder.string() + ": no folder; expected that of a run");
  }
  if (!fs::exists(folder / "scene.toml", ignored)) {
    throw SceneError(folder.string() + ": no scene.toml in it; expected the folder of a run");
  }
  return scene_dimension(folder / "scene.toml");
}

// ---- States -------------------------------------------------------------------------------------

template <int Dim>
RunFolder<Dim>::RunFolder(fs::path folder)
    : folder_(std::move(folder)), scene_(read_scene<Dim>(folder_ / "scene.toml")) {
  std::error_code ignored;
  if (fs::exists(folder_ / "frames.csv", ignored)) {
    CsvFile list(folder_ / "frames.csv");
    const std::size_t number = list.column("frame"), step = list.column("step"),
                      time = list.column("time");
    while (list.next()) {
      const std::int64_t frame = list.whole(number);
      const std::string name = numbered("", frame, ".csv");
      Listed listed;
      listed.source = "frame " + std::to_string(frame);
      listed.file = folder_ / "frames" / name;
      listed.contacts = folder_ / "contacts" / name;
      listed.step = list.whole(step);
      listed.time = list.number(time);
      if (!fs::exists(listed.contacts, ignored)) listed.contacts.clear();
      if (fs::exists(listed.file, ignored)) frames_.push_back(std::move(listed));
    }
  }
  try {
    checkpoint_ = read_checkpoint(folder_);
  } catch (const SceneError&) {
    // Frames may do.
  }
}

template <int Dim>
const Run<Dim>* RunFolder<Dim>::checkpointed() const {
  if (!run_ && checkpoint_) run_ = resume_run<Dim>(*checkpoint_, {}, 1);
  return run_.get();
}

template <int Dim>
Snapshot<Dim> RunFolder<Dim>::at(std::size_t frame, Wish wish) const {
  return read(frames_[frame], wish);
}

template <int Dim>
Snapshot<Dim> RunFolder<Dim>::nearest(std::optional<double> time, Wish wish) const {
  const auto distance = [&](double t) { return time ? std::abs(t - *time) : -t; };
  const Listed* best = nullptr;
  const auto consider = [&](const Listed& listed) {
    if (best == nullptr || distance(listed.time) <= distance(best->time)) best = &listed;
  };
  for (const Listed& listed : frames_) consider(listed);
  double kept = kNever;  // when the checkpoint was taken
  if (checkpoint_) {
    const auto& steps = checkpoint_->state.template get<NumberTable<std::int64_t>>("run/step");
    if (!steps.numbers.empty()) {
      kept = static_cast<double>(steps.numbers.front()) * scene_.time_step.seconds;
    }
  }
  if (best == nullptr && kept == kNever) {
    throw SceneError(folder_.string() +
                     ": no state of its grains yet, neither frames/NNNN.csv nor checkpoint.h5");
  }
  // The checkpoint of a run at its end is of the time of its last frame, and knows the forces too.
  const double slack = 0.5 * scene_.time_step.seconds;
  if (kept < kNever && (best == nullptr || distance(kept) < distance(best->time) - slack ||
                        (wish.contacts && best->contacts.empty() &&
                         distance(kept) <= distance(best->time) + slack))) {
    const Run<Dim>& run = *checkpointed();
    Snapshot<Dim> snapshot = snapshot_of(run);
    snapshot.source = "the checkpoint";
    return snapshot;
  }
  return read(*best, wish);
}

template <int Dim>
Snapshot<Dim> RunFolder<Dim>::read(const Listed& listed, Wish wish) const {
  Snapshot<Dim> snapshot;
  snapshot.source = listed.source;
  snapshot.frame = read_grains(listed);
  snapshot.walls = walls_at(listed.time);
  if (wish.contacts) {
    if (listed.contacts.empty()) {
      throw SceneError(folder_.string() + ": the forces at t = " + rounded(listed.time, 4) +
                       " s are not kept; to keep them beside each frame, write contacts = true "
                       "under [output] of the scene and run it again" +
                       (checkpoint_ ? " (those of the end are in its checkpoint)" : ""));
    }
    snapshot.contacts = read_contacts(listed.contacts, snapshot);
  }
  if (wish.groups) {
    const Run<Dim>* run = checkpointed();
    if (run == nullptr) {
      throw SceneError(folder_.string() +
                       ": no checkpoint, which is what knows the groups of grains");
    }
    const auto names = group_names(scene_);
    snapshot.group.assign(snapshot.frame.id.size(), "left since");
    for (int i = 0; i < run->count(); ++i) {
      const int place = place_of(snapshot.frame.id, run->id(i));
      if (place < 0) continue;
      snapshot.group[static_cast<std::size_t>(place)] =
          group_name(names, run->groups()[static_cast<std::size_t>(i)]);
    }
  }
  return snapshot;
}

template <int Dim>
Frame<Dim> RunFolder<Dim>::read_grains(const Listed& listed) const {
  CsvFile csv(listed.file);
  const auto columns = [&](const std::string& stem, int count) {
    std::vector<std::size_t> places;
    for (int d = 0; d < count; ++d) places.push_back(csv.column(stem + "xyz"[d]));
    return places;
  };
  const std::size_t id = csv.column("id"), radius = csv.column("radius"),
                    material = csv.column("material");
  const auto position = columns("", Dim), velocity = columns("v", Dim);
  std::vector<std::size_t> spin;
  if (Dim == 2 && csv.find("omega")) spin = {csv.column("omega")};
  if (Dim == 3 && csv.find("omega_x")) spin = columns("omega_", 3);
  std::vector<double> numbers, radii;
  Frame<Dim> frame;
  while (csv.next()) {
    frame.id.push_back(static_cast<int>(csv.whole(id)));
    for (const std::size_t c : position) numbers.push_back(csv.number(c));
    for (const std::size_t c : velocity) numbers.push_back(csv.number(c));
    for (const std::size_t c : spin) numbers.push_back(csv.number(c));
    radii.push_back(csv.number(radius));
    const std::string name = csv.word(material);
    int m = 0;
    while (m + 1 < static_cast<int>(scene_.materials.size()) &&
           scene_.materials[static_cast<std::size_t>(m)].name != name) {
      ++m;
    }
    frame.material.push_back(m);
  }
  const auto n = static_cast<Eigen::Index>(radii.size());
  const auto width = static_cast<Eigen::Index>(2 * Dim + static_cast<int>(spin.size()));
  const Eigen::Map<const Eigen::MatrixXd> all(numbers.data(), width, n);
  frame.step = listed.step;
  frame.time = listed.time;
  frame.position = all.topRows(Dim);
  frame.velocity = all.middleRows(Dim, Dim);
  if (!spin.empty()) frame.spin = all.bottomRows(static_cast<Eigen::Index>(spin.size()));
  frame.radius = Eigen::Map<const Eigen::VectorXd>(radii.data(), n);
  return frame;
}

template <int Dim>
std::vector<ContactRecord<Dim>> RunFolder<Dim>::read_contacts(const fs::path& file,
                                                              const Snapshot<Dim>& snapshot) const {
  CsvFile csv(file);
  const std::size_t i = csv.column("i"), j = csv.column("j"), wall = csv.column("wall"),
                    overlap = csv.column("overlap");
  std::vector<std::size_t> normal, force;
  for (int d = 0; d < Dim; ++d) normal.push_back(csv.column(std::string("n") + "xyz"[d]));
  for (int d = 0; d < Dim; ++d) force.push_back(csv.column(std::string("f") + "xyz"[d]));
  std::vector<ContactRecord<Dim>> contacts;
  while (csv.next()) {
    ContactRecord<Dim> contact;
    contact.i = place_of(snapshot.frame.id, csv.whole(i));
    contact.j = place_of(snapshot.frame.id, csv.whole(j));
    contact.wall = static_cast<int>(csv.whole(wall));
    contact.overlap = csv.number(overlap);
    for (int d = 0; d < Dim; ++d) {
      contact.normal[d] = csv.number(normal[static_cast<std::size_t>(d)]);
      contact.force[d] = csv.number(force[static_cast<std::size_t>(d)]);
    }
    if (contact.i >= 0) contacts.push_back(contact);
  }
  return contacts;
}

template <int Dim>
std::vector<Wall<Dim>> RunFolder<Dim>::walls_at(double time) const {
  std::vector<Wall<Dim>> walls = scene_.walls;
  bool pistons = false;
  for (Wall<Dim>& wall : walls) {
    pistons = pistons || wall.yields();
    if (!wall.yields()) wall.advance(time, 0);
  }
  std::error_code ignored;
  if (!pistons || !fs::exists(folder_ / "series.csv", ignored)) return walls;
  // Pistons are where grains have pushed them: the series knows.
  CsvFile series(folder_ / "series.csv");
  const std::size_t time_column = series.column("time");
  double before = -kNever;
  std::vector<Wall<Dim>> then = walls;
  while (series.next()) {
    const double now = series.number(time_column);
    const double share = before == -kNever || now <= time
                             ? 1
                             : std::clamp((time - before) / (now - before), 0.0, 1.0);
    for (std::size_t w = 0; w < walls.size(); ++w) {
      if (!walls[w].yields() || !series.find(walls[w].name + ".x")) continue;
      Vec<Dim> point;
      for (int d = 0; d < Dim; ++d) {
        point[d] = series.number(series.column(walls[w].name + "." + "xyz"[d]));
      }
      walls[w].point = then[w].point + share * (point - then[w].point);
      then[w].point = point;
    }
    if (now >= time) break;
    before = now;
  }
  return walls;
}

template Snapshot<2> snapshot_of<2>(const Run<2>&);
template Snapshot<3> snapshot_of<3>(const Run<3>&);
template class RunFolder<2>;
template class RunFolder<3>;

}  // namespace lagrain::figures
