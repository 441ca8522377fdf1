// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/csv.hpp>
#include <lagrain/files.hpp>

#include <lagrain/check.hpp>

#include "support/files.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

using namespace lagrain;
using namespace lagrain::test;

TEST_SUITE("files") {
  TEST_CASE("numbers in a table read back bit for bit, words with commas stand in quotes") {
    Csv csv("a[m],b[-]");
    csv.row(0.1, 7);
    csv.row(std::nextafter(1.0, 2), "one, \"two\"");
    csv.word("x");
    csv.number(std::numeric_limits<double>::quiet_NaN());
    csv.vector(Eigen::Vector2d(1, -0.0));
    csv.end();

    CHECK(csv.text() == "a[m],b[-]\n0.1,7\n1.0000000000000002,\"one, \"\"two\"\"\"\nx,,1,-0\n");
    CHECK(csv.take().size() > 0);
    CHECK(csv.text().empty());
  }

  TEST_CASE("what has been added to a growing file is there before it is closed") {
    const Folder folder;
    make_folder(folder.path);
    GrowingFile file(folder.path / "series.csv");

    file.add("a\n");
    CHECK(content(folder.path / "series.csv") == "a\n");
    file.add("b\n");
    CHECK(content(folder.path / "series.csv") == "a\nb\n");
  }

  TEST_CASE("a file that cannot grow says so, with its name and the reason") {
    CHECK_THROWS_WITH_AS(GrowingFile("no/such/folder/series.csv"),
                         "no/such/folder/series.csv: cannot be written: No such file or directory",
                         SceneError);
    if (std::filesystem::exists("/dev/full")) {
      GrowingFile full("/dev/full");
      CHECK_THROWS_WITH_AS(full.add("x\n"), "/dev/full: cannot be written: No space left on device",
                           SceneError);
    }
  }
}
