// SPDX-License-Identifier: GPL-3.0-or-later
// Are the pictures of all kinds of OpenGL contexts the same bits? A process has one context, so
// each kind paints in a process of its own. This is a program of its own because it has to fork()
// before the first picture, whose painter starts threads.

#include "context.hpp"
#include "support.hpp"

#include <lagrain/paint.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>

using namespace lagrain;

namespace {

constexpr int kSkipped = 77;  // SKIP_RETURN_CODE of the test

std::filesystem::path file_of(const test::Folder& folder, const detail::ContextKind& kind,
                              const std::string& picture) {
  return folder.path / (kind.name + ('_' + picture) + ".png");
}

// Paints a page of figures, and spheres in shadow, with one kind of context.
void paint_all(const detail::ContextKind& kind, const test::Folder& folder) {
  setenv("LAGRAIN_GL", kind.name, 1);
  setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
  write_png(paint_rgba(test::mixed_list(), 150), file_of(folder, kind, "plane"));
  write_png(paint_scene3(test::heap(), 400, 400), file_of(folder, kind, "space"));
}

bool paint_in_a_process(const detail::ContextKind& kind, const test::Folder& folder) {
  const pid_t child = fork();
  if (child == 0) {
    int status = 0;
    try {
      paint_all(kind, folder);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: %s\n", kind.name, error.what());
      status = 1;
    }
    // Not exit(): the folder is the parent's.
    _exit(status);
  }
  int status = 0;
  return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

int main() {
  const auto kinds = detail::context_kinds();
  if (kinds.size() < 2) {
    std::printf("skipped: this build draws with %s alone\n", kinds.front().name);
    return kSkipped;
  }
  const test::MadeFolder folder;
  for (const detail::ContextKind& kind : kinds) {
    if (!paint_in_a_process(kind, folder)) return 1;
  }
  int different = 0;
  for (const std::string picture : {"plane", "space"}) {
    const std::string expected = test::content(file_of(folder, kinds.front(), picture));
    for (const detail::ContextKind& kind : kinds.subspan(1)) {
      const bool same = test::content(file_of(folder, kind, picture)) == expected;
      std::printf("%s: the picture of %s is %s that of %s\n", picture.c_str(), kind.name,
                  same ? "the same as" : "NOT", kinds.front().name);
      different += same ? 0 : 1;
    }
  }
  return different == 0 ? 0 : 1;
}
