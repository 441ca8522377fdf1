// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/csv.hpp>
#include <lagrain/format.hpp>

#include <algorithm>
#include <system_error>
#include <vector>

namespace lagrain {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostDigits = 18;  // of the number of a frame

std::string numbered(std::int64_t number) {
  std::string digits = std::to_string(number);
  if (digits.size() < 4) digits.insert(0, 4 - digits.size(), '0');
  return digits + ".csv";
}

/// Removes NNNN.csv of an earlier run, from a number on; whatever else lies there is not ours.
void remove_numbered(const fs::path& folder, std::int64_t first) {
  std::error_code failure;
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() == ".csv" && stem.size() >= 4 &&
        std::all_of(stem.begin(), stem.end(), [](char c) { return c >= '0' && c <= '9'; }) &&
        stem.size() <= kMostDigits && std::stoll(stem) >= first) {
      old.push_back(entry.path());
    }
  }
  for (const fs::path& file : old) fs::remove(file, failure);
}

}  // namespace

template <int Dim>
void CsvFormat<Dim>::begin(const Run<Dim>& run) {
  make_folders(run);
  remove_frames(0);
  series_.emplace(folder_ / "series.csv");
  frames_.emplace(folder_ / "frames.csv");

  Csv header;
  for (const SeriesColumn& column : series_columns(run)) {
    header.word(column.name + "[" + column.unit + "]");
  }
  header.end();
  series_->add(header.take());
  frames_->add(Csv("frame[-],step[-],time[s]").take());
}

template <int Dim>
void CsvFormat<Dim>::sync_to_disk() const {
  series_->sync_to_disk();
  frames_->sync_to_disk();
}

template <int Dim>
void CsvFormat<Dim>::persist(const Run<Dim>& run, StateVisitor visit, std::int64_t frames) {
  std::int64_t series_length = 0, frames_length = 0;
  if (!visit.restores()) {
    series_length = static_cast<std::int64_t>(series_->length());
    frames_length = static_cast<std::int64_t>(frames_->length());
  }
  visit("series_bytes", series_length);
  visit("frames_bytes", frames_length);
  if (!visit.restores()) return;
  make_folders(run);
  series_.emplace(folder_ / "series.csv", static_cast<std::uintmax_t>(series_length));
  frames_.emplace(folder_ / "frames.csv", static_cast<std::uintmax_t>(frames_length));
  remove_frames(frames);
}

template <int Dim>
void CsvFormat<Dim>::make_folders(const Run<Dim>& run) const {
  make_folder(folder_ / "frames");
  if (run.scene().output.contacts) make_folder(folder_ / "contacts");
}

template <int Dim>
void CsvFormat<Dim>::remove_frames(std::int64_t first) const {
  remove_numbered(folder_ / "frames", first);
  remove_numbered(folder_ / "contacts", first);
  std::error_code ignored;
  fs::remove(folder_ / "last.csv", ignored);
}

template <int Dim>
void CsvFormat<Dim>::add_sample(const Sample& sample) {
  Csv row;
  for (const auto& value : sample) {
    std::visit([&](auto number) { row.number(number); }, value);
  }
  row.end();
  series_->add(row.take());
}

template <int Dim>
void CsvFormat<Dim>::add_frame(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) {
  write_file(folder_ / "frames" / numbered(number), frame_csv(run, frame));
  if (run.scene().output.contacts) {
    write_file(folder_ / "contacts" / numbered(number), contacts_csv(run));
  }
  Csv row;
  row.row(number, frame.step, frame.time);
  frames_->add(row.take());
}

template <int Dim>
fs::path CsvFormat<Dim>::write_last(const Run<Dim>& run, const Frame<Dim>& frame) {
  fs::path file = folder_ / "last.csv";
  write_file(file, frame_csv(run, frame));
  return file;
}

template <int Dim>
std::string frame_csv(const Run<Dim>& run, const Frame<Dim>& frame) {
  Csv csv;
  csv.word("id[-]");
  csv.names(Dim, "", "m");
  csv.names(Dim, "v", "m/s");
  if (frame.spin) {
    if (Dim == 2) {
      csv.word("omega[rad/s]");
    } else {
      csv.names(Dim, "omega_", "rad/s");
    }
  }
  csv.word("radius[m]");
  csv.word("material[-]");
  csv.end();
  for (Eigen::Index i = 0; i < frame.position.cols(); ++i) {
    csv.number(frame.id[static_cast<std::size_t>(i)]);
    csv.vector(frame.position.col(i));
    csv.vector(frame.velocity.col(i));
    if (frame.spin) csv.vector(frame.spin->col(i));
    csv.number(frame.radius[i]);
    const auto m = static_cast<std::size_t>(frame.material[static_cast<std::size_t>(i)]);
    csv.word(run.scene().materials[m].name);
    csv.end();
  }
  return csv.take();
}

template <int Dim>
std::string contacts_csv(const Run<Dim>& run) {
  Csv csv;
  csv.word("i[-]");
  csv.word("j[-]");
  csv.word("overlap[m]");
  csv.names(Dim, "n", "-");
  csv.names(Dim, "f", "N");
  csv.end();
  for (const ContactRecord<Dim>& contact : run.contacts()) {
    csv.number(run.id(contact.i));
    if (contact.wall < 0) {
      csv.number(run.id(contact.j));
    } else {
      csv.word(run.walls()[static_cast<std::size_t>(contact.wall)].name);
    }
    csv.number(contact.overlap);
    csv.vector(contact.normal);
    csv.vector(contact.force);
    csv.end();
  }
  return csv.take();
}

template class CsvFormat<2>;
template class CsvFormat<3>;
template std::string frame_csv<2>(const Run<2>&, const Frame<2>&);
template std::string frame_csv<3>(const Run<3>&, const Frame<3>&);
template std::string contacts_csv<2>(const Run<2>&);
template std::string contacts_csv<3>(const Run<3>&);

}  // namespace lagrain
