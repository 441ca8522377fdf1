// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/video.hpp>

#include "support.hpp"

#include <lagrain/check.hpp>

#include <doctest/doctest.h>

#include <cstdlib>
#include <string>

using namespace lagrain;
using lagrain::test::content;
using lagrain::test::MadeFolder;

namespace {

Image frame(int k) {
  DisplayList list{65, 48};
  list.add(Disc{{10.0 + 4 * k, 24}, 8, {200, 30, 30, 255}, {}});
  return paint_rgba(list, 72, Quality::frame);
}

/// Hides every program while it lives.
struct EmptyPath {
  std::string before;
  EmptyPath() : before(std::getenv("PATH") ? std::getenv("PATH") : "") { setenv("PATH", "", 1); }
  ~EmptyPath() { setenv("PATH", before.c_str(), 1); }
};

}  // namespace

TEST_SUITE("video") {
  TEST_CASE("without ffmpeg the frames become numbered pictures") {
    const MadeFolder folder;
    const EmptyPath nothing;

    VideoWriter video(folder.path / "fall.mp4", 25);
    for (int k = 0; k < 3; ++k) video.add(frame(k));
    const VideoReport report = video.finish();

    CHECK_FALSE(report.encoded);
    CHECK(report.frames == 3);
    CHECK(report.path == folder.path / "fall_frames");
    CHECK(content(report.path / "000002.png").substr(1, 3) == "PNG");
    CHECK_FALSE(std::filesystem::exists(folder.path / "fall.mp4"));
  }

  TEST_CASE("a video that is not finished leaves nothing") {
    const MadeFolder folder;
    {
      VideoWriter video(folder.path / "a.mp4", 25);
      if (std::system("command -v ffmpeg >/dev/null 2>&1") == 0) video.add(frame(0));
    }
    CHECK(folder.empty());
  }

  TEST_CASE("wrong use of a video is refused") {
    const MadeFolder folder;

    CHECK_THROWS_AS(VideoWriter(folder.path / "a.avi", 25), SceneError);
    CHECK_THROWS_AS(VideoWriter(folder.path / "missing" / "a.mp4", 25), SceneError);
    CHECK_THROWS_AS(VideoWriter(folder.path / "a.mp4", 0), ContractError);
    CHECK_THROWS_AS(VideoWriter(folder.path / "a.mp4", 25).finish(), ContractError);
    VideoWriter video(folder.path / "a.mp4", 25);
    video.add(frame(0));
    CHECK_THROWS_AS(video.add(Image{2, 2, std::vector<std::uint8_t>(16)}), ContractError);
  }
}

TEST_SUITE("ffmpeg") {
  TEST_CASE("with ffmpeg there is one video, the same each time, and nothing beside it") {
    if (std::system("command -v ffmpeg >/dev/null 2>&1") != 0) {
      MESSAGE("SKIPPED: ffmpeg is not installed");
      return;
    }
    for (const std::string ending : {".mp4", ".webm"}) {
      const MadeFolder folder;
      for (const std::string name : {"it's a", "b"}) {
        VideoWriter video(folder.path / (name + ending), 25);
        for (int k = 0; k < 5; ++k) video.add(frame(k));
        const VideoReport report = video.finish();
        CHECK(report.encoded);
        CHECK(report.frames == 5);
        CHECK(std::filesystem::file_size(report.path) > 500);
      }
      const bool equal =
          content(folder.path / ("it's a" + ending)) == content(folder.path / ("b" + ending));
      CHECK_MESSAGE(equal, ending);
      CHECK(std::distance(std::filesystem::directory_iterator(folder.path), {}) == 2);
    }
  }
}
