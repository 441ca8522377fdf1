// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame_formats.hpp"

#include <lagrain/csv.hpp>

#include <algorithm>
#include <system_error>
#include <vector>

namespace lagrain {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFewestDigits = 4, kMostDigits = 18;  // of the number of a frame
constexpr const char* kGrains = "frames";
constexpr const char* kContacts = "contacts";

}  // namespace

std::string numbered(std::string_view stem, std::int64_t number, std::string_view ending) {
  std::string digits = std::to_string(number);
  if (digits.size() < kFewestDigits) digits.insert(0, kFewestDigits - digits.size(), '0');
  return std::string(stem) + digits + std::string(ending);
}

void remove_numbered(const fs::path& folder, std::string_view stem, std::string_view ending,
                     std::int64_t first) {
  std::error_code failure;
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    const std::string name = entry.path().filename().string();
    if (name.size() < stem.size() + ending.size() + kFewestDigits) continue;
    if (!name.starts_with(stem) || !name.ends_with(ending)) continue;
    const std::string digits = name.substr(stem.size(), name.size() - stem.size() - ending.size());
    if (digits.size() <= kMostDigits &&
        std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; }) &&
        std::stoll(digits) >= first) {
      old.push_back(entry.path());
    }
  }
  for (const fs::path& file : old) fs::remove(file, failure);
}

template <int Dim>
std::vector<std::unique_ptr<FrameFormat<Dim>>> make_formats(const OutputPlan& plan,
                                                            const fs::path& folder) {
  std::vector<std::unique_ptr<FrameFormat<Dim>>> formats;
  for (const OutputFormat format : plan.formats) {
    switch (format) {
      case OutputFormat::csv:
        formats.push_back(std::make_unique<detail::CsvFrames<Dim>>(folder));
        break;
      case OutputFormat::vtp:
        formats.push_back(std::make_unique<detail::VtpFrames<Dim>>(folder));
        break;
      case OutputFormat::cells:
        formats.push_back(std::make_unique<detail::CellFrames<Dim>>(folder));
        break;
      case OutputFormat::hdf5:
        formats.push_back(std::make_unique<detail::Hdf5Frames<Dim>>(folder));
        break;
      case OutputFormat::xyz:
        formats.push_back(std::make_unique<detail::XyzFrames<Dim>>(folder));
        break;
    }
  }
  return formats;
}

namespace detail {

template <int Dim>
void CsvFrames<Dim>::begin(const Run<Dim>& run) {
  clear(run, 0);
}

template <int Dim>
void CsvFrames<Dim>::persist(const Run<Dim>& run, StateVisitor visit, std::int64_t frames) {
  if (visit.restores()) clear(run, frames);
}

template <int Dim>
void CsvFrames<Dim>::clear(const Run<Dim>& run, std::int64_t first) const {
  make_folder(folder_ / kGrains);
  if (run.scene().output.contacts) make_folder(folder_ / kContacts);
  for (const char* name : {kGrains, kContacts}) remove_numbered(folder_ / name, "", ".csv", first);
}

template <int Dim>
void CsvFrames<Dim>::add_frame(const Run<Dim>& run, const Frame<Dim>& frame, std::int64_t number) {
  const std::string name = numbered("", number, ".csv");
  write_file(folder_ / kGrains / name, frame_csv(run, frame));
  if (run.scene().output.contacts) write_file(folder_ / kContacts / name, contacts_csv(run));
}

template <int Dim>
double CsvFrames<Dim>::bytes_per_frame(const Run<Dim>& run, double contacts) const {
  const int numbers = 2 * Dim + 1 + (run.spins() != nullptr ? kSpinDim<Dim> : 0);
  constexpr double kWords = 12;  // id and material
  double bytes = run.count() * (numbers * kTextBytes + kWords);
  if (run.scene().output.contacts) bytes += contacts * ((2 * Dim + 1) * kTextBytes + kWords);
  return bytes;
}

template class CsvFrames<2>;
template class CsvFrames<3>;

}  // namespace detail

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
  csv.word("wall[-]");
  csv.word("overlap[m]");
  csv.names(Dim, "n", "-");
  csv.names(Dim, "f", "N");
  csv.end();
  for (const ContactRecord<Dim>& contact : run.contacts()) {
    csv.number(run.id(contact.i));
    csv.number(contact.wall < 0 ? run.id(contact.j) : -1);
    csv.number(contact.wall);
    csv.number(contact.overlap);
    csv.vector(contact.normal);
    csv.vector(contact.force);
    csv.end();
  }
  return csv.take();
}

template std::vector<std::unique_ptr<FrameFormat<2>>> make_formats<2>(const OutputPlan&,
                                                                      const fs::path&);
template std::vector<std::unique_ptr<FrameFormat<3>>> make_formats<3>(const OutputPlan&,
                                                                      const fs::path&);
template std::string frame_csv<2>(const Run<2>&, const Frame<2>&);
template std::string frame_csv<3>(const Run<3>&, const Frame<3>&);
template std::string contacts_csv<2>(const Run<2>&);
template std::string contacts_csv<3>(const Run<3>&);

}  // namespace lagrain
