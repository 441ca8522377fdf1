// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/csv.hpp>
#include <lagrain/format.hpp>

#include <variant>

namespace lagrain {

template <int Dim>
void RunTables<Dim>::begin(const Run<Dim>& run) {
  series_.emplace(series_file_);
  frames_.emplace(frames_file_);
  Csv header;
  for (const SeriesColumn& column : series_columns(run)) {
    header.word(column.name + "[" + column.unit + "]");
  }
  header.end();
  series_->add(header.take());
  frames_->add(Csv("frame[-],step[-],time[s]").take());
}

template <int Dim>
void RunTables<Dim>::persist(StateVisitor visit) {
  std::int64_t series_length = 0, frames_length = 0;
  if (!visit.restores()) {
    series_length = static_cast<std::int64_t>(series_->length());
    frames_length = static_cast<std::int64_t>(frames_->length());
  }
  visit("series_bytes", series_length);
  visit("frames_bytes", frames_length);
  if (!visit.restores()) return;
  series_.emplace(series_file_, static_cast<std::uintmax_t>(series_length));
  frames_.emplace(frames_file_, static_cast<std::uintmax_t>(frames_length));
}

template <int Dim>
void RunTables<Dim>::sync_to_disk() const {
  series_->sync_to_disk();
  frames_->sync_to_disk();
}

template <int Dim>
void RunTables<Dim>::add_sample(const Sample& sample) {
  Csv row;
  for (const auto& value : sample) {
    std::visit([&](auto number) { row.number(number); }, value);
  }
  row.end();
  series_->add(row.take());
}

template <int Dim>
void RunTables<Dim>::add_frame(const Frame<Dim>& frame, std::int64_t number) {
  Csv row;
  row.row(number, frame.step, frame.time);
  frames_->add(row.take());
}

template class RunTables<2>;
template class RunTables<3>;

}  // namespace lagrain
