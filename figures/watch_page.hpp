// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// A page in the folder of a run that shows how far it is. It needs no server: the browser reads it
/// again from the disk every few seconds, until the run has ended.

#include <lagrain/output.hpp>

#include <chrono>
#include <filesystem>
#include <string>

namespace lagrain::figures {

/// Writes watch.html, watch.png and watch_series.png into the folder of a run: the grains as they
/// are, the energies of the series, and the ledger.
template <int Dim>
class WatchPage {
 public:
  /// @throws SceneError if this program was built without the renderer
  WatchPage(const Run<Dim>& run, std::filesystem::path folder);

  /// Renews the page if that is due: after two seconds, and no more often than that a fiftieth of
  /// the time goes into it. What cannot be drawn or written is left out, and the run goes on.
  void look(const Progress& progress);
  /// Renews the page for the last time.
  /// @param how  the run has ended, "finished"
  void end(const std::string& how);

 private:
  void write(const std::string& state, bool goes_on) const;
  /// What the page shows as pictures, or why there are none.
  std::string pictures() const;

  const Run<Dim>& run_;
  std::filesystem::path folder_;
  std::chrono::steady_clock::time_point due_{};
};

}  // namespace lagrain::figures
