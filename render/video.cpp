// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/video.hpp>

#include "image_io.hpp"

#include <lagrain/check.hpp>

#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

namespace lagrain {
namespace {

bool on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  if (path == nullptr) return false;
  const std::string all = path;
  for (std::size_t from = 0; from <= all.size();) {
    const std::size_t end = std::min(all.find(':', from), all.size());
    const std::string candidate = all.substr(from, end - from).append("/").append(program);
    if (access(candidate.c_str(), X_OK) == 0) return true;
    from = end + 1;
  }
  return false;
}

std::string quoted(const std::filesystem::path& path) {
  std::string out = "'";
  for (const char c : path.string()) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// Holds SIGPIPE back on this thread, and takes away the one that we caused: writing to an encoder
// that has died raises it, and it would end the program.
class NoBrokenPipe {
 public:
  NoBrokenPipe() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoBrokenPipe() {
    if (sigismember(&before_, SIGPIPE) == 0) {
      const timespec at_once{0, 0};
      sigtimedwait(&pipe_, nullptr, &at_once);
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoBrokenPipe(const NoBrokenPipe&) = delete;
  NoBrokenPipe& operator=(const NoBrokenPipe&) = delete;

 private:
  sigset_t pipe_{}, before_{};
};

}  // namespace

struct VideoWriter::State {
  std::filesystem::path path;  // of the video
  int fps = 0;
  bool encode = false;
  int width = 0, height = 0, frames = 0;
  std::FILE* pipe = nullptr;
  std::filesystem::path part, log, folder;
  std::vector<std::uint8_t> row;

  ~State() {
    if (pipe == nullptr) return;
    const NoBrokenPipe guard;
    pclose(pipe);
    clean();
  }

  void clean() const {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    std::filesystem::remove(log, ignored);
  }

  [[noreturn]] void fail() {
    if (pipe != nullptr) {
      const NoBrokenPipe guard;
      pclose(pipe);
      pipe = nullptr;
    }
    std::string why;
    std::getline(std::ifstream(log), why);
    clean();
    throw SceneError(path.string() +
                     ": cannot be written: " + (why.empty() ? std::string("ffmpeg failed") : why));
  }

  void open(const Image& frame) {
    LAGRAIN_EXPECTS(frame.width >= 2 && frame.height >= 2, "VideoWriter: a frame of " +
                                                               std::to_string(frame.width) + " x " +
                                                               std::to_string(frame.height));
    width = frame.width;
    height = frame.height;
    if (!encode) {
      std::error_code error;
      std::filesystem::create_directories(folder, error);
      if (error) throw SceneError(folder.string() + ": cannot be written: " + error.message());
      return;
    }
    // Constant quality, so high that compression is not seen.
    const std::string codec = path.extension() == ".mp4"
                                  ? "-c:v libx264 -crf 18 -preset medium -movflags +faststart"
                                  : "-c:v libvpx-vp9 -crf 24 -b:v 0 -row-mt 1";
    // -bitexact leaves out the encoder's version and the date: same frames, same bytes.
    const std::string command =
        "ffmpeg -hide_banner -loglevel error -nostdin -y -f rawvideo -pixel_format rgb24 "
        "-video_size " +
        std::to_string(width & ~1) + "x" + std::to_string(height & ~1) + " -framerate " +
        std::to_string(fps) + " -i - " + codec + " -pix_fmt yuv420p -fflags +bitexact " +
        quoted(std::filesystem::absolute(part)) + " >/dev/null 2>" + quoted(log);
    pipe = popen(command.c_str(), "w");
    if (pipe == nullptr) fail();
  }
};

VideoWriter::VideoWriter(const std::filesystem::path& path, int fps)
    : state_(std::make_unique<State>()) {
  LAGRAIN_EXPECTS(fps >= 1, "VideoWriter: " + std::to_string(fps) + " frames per second");
  if (path.extension() != ".mp4" && path.extension() != ".webm") {
    throw SceneError(path.string() + ": a video ends in .mp4 or .webm");
  }
  state_->path = path;
  state_->fps = fps;
  state_->encode = on_path("ffmpeg");
  state_->part = detail::unfinished(path);
  state_->log = state_->part;
  state_->log += ".log";
  state_->folder = path.parent_path() / path.stem();
  state_->folder += "_frames";
  // A folder that cannot be written fails here, before hours of frames.
  detail::write_whole(state_->log, "");
  std::error_code ignored;
  std::filesystem::remove(state_->log, ignored);
}

VideoWriter::~VideoWriter() = default;
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;

void VideoWriter::add(const Image& frame) {
  State& s = *state_;
  if (s.frames == 0) s.open(frame);
  LAGRAIN_EXPECTS(frame.width == s.width && frame.height == s.height,
                  "VideoWriter: frame " + std::to_string(s.frames) + " has " +
                      std::to_string(frame.width) + " x " + std::to_string(frame.height) +
                      " pixels, the first had " + std::to_string(s.width) + " x " +
                      std::to_string(s.height));
  if (!s.encode) {
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "%06d.png", s.frames);
    write_png(frame, s.folder / name.data());
    ++s.frames;
    return;
  }
  const NoBrokenPipe guard;
  const auto width = static_cast<std::size_t>(s.width & ~1);
  s.row.resize(3 * width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(s.height & ~1); ++y) {
    const std::uint8_t* from = frame.rgba.data() + 4 * static_cast<std::size_t>(s.width) * y;
    for (std::size_t x = 0; x < width; ++x) {
      const int alpha = from[4 * x + 3];
      for (std::size_t c = 0; c < 3; ++c) {
        s.row[3 * x + c] =
            static_cast<std::uint8_t>((from[4 * x + c] * alpha + 255 * (255 - alpha) + 127) / 255);
      }
    }
    if (std::fwrite(s.row.data(), 1, s.row.size(), s.pipe) != s.row.size()) s.fail();
  }
  ++s.frames;
}

VideoReport VideoWriter::finish() {
  State& s = *state_;
  LAGRAIN_EXPECTS(s.frames > 0, "VideoWriter: no frames");
  if (!s.encode) return {false, s.folder, s.frames};
  int status = 0;
  {
    const NoBrokenPipe guard;
    status = pclose(s.pipe);
  }
  s.pipe = nullptr;
  if (status != 0) s.fail();
  std::error_code error;
  std::filesystem::rename(s.part, s.path, error);
  if (error) {
    s.clean();
    throw SceneError(s.path.string() + ": cannot be written: " + error.message());
  }
  s.clean();
  return {true, s.path, s.frames};
}

}  // namespace lagrain
