// SPDX-License-Identifier: GPL-3.0-or-later
#include "image_io.hpp"

#include <lagrain/check.hpp>

#include <png.h>

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <fstream>
#include <memory>
#include <system_error>

namespace lagrain {
namespace detail {

std::filesystem::path unfinished(const std::filesystem::path& path) {
  std::filesystem::path name = ".";
  name += path.stem();
  name += std::string("-").append(std::to_string(getpid())).append(".part");
  name += path.extension();
  return path.parent_path() / name;
}

void write_whole(const std::filesystem::path& path, std::string_view bytes) {
  const auto fail = [&](const std::string& why) {
    throw SceneError(path.string() + ": cannot be written: " + why);
  };
  if (std::filesystem::is_directory(path)) fail("it is a folder");
  const std::filesystem::path part = unfinished(path);
  std::error_code ignored;
  errno = 0;
  {
    std::ofstream file(part, std::ios::binary);
    if (!file) fail(std::strerror(errno));
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) {
      const std::string why = std::strerror(errno);
      std::filesystem::remove(part, ignored);
      fail(why);
    }
  }
  std::error_code error;
  std::filesystem::rename(part, path, error);
  if (error) {
    std::filesystem::remove(part, ignored);
    fail(error.message());
  }
}

std::string encode_png(const Image& image, double dpi) {
  LAGRAIN_EXPECTS(image.width > 0 && image.height > 0 &&
                      image.rgba.size() == 4 * static_cast<std::size_t>(image.width) *
                                               static_cast<std::size_t>(image.height),
                  "encode_png: an image of " + std::to_string(image.width) + " x " +
                      std::to_string(image.height) + " pixels holds " +
                      std::to_string(image.rgba.size()) + " bytes");
  const auto pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  bool opaque = true;
  for (std::size_t k = 0; k < pixels && opaque; ++k) opaque = image.rgba[4 * k + 3] == 255;

  std::string out, why;
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<std::uint8_t> row((opaque ? 3 : 4) * width);
  png_structp png = png_create_write_struct(
      PNG_LIBPNG_VER_STRING, &why,
      [](png_structp p, png_const_charp message) {
        *static_cast<std::string*>(png_get_error_ptr(p)) = message;
        png_longjmp(p, 1);
      },
      [](png_structp, png_const_charp) {});
  png_infop info = png_create_info_struct(png);
  struct Guard {
    png_structp& png;
    png_infop& info;
    ~Guard() { png_destroy_write_struct(&png, &info); }
  } guard{png, info};
  // libpng leaves by longjmp: no object with a destructor may be born below this line.
  if (setjmp(png_jmpbuf(png)) != 0) throw SceneError("libpng: " + why);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep bytes, std::size_t count) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(bytes), count);
      },
      [](png_structp) {});

  // Figures are flat areas with thin lines: the plain difference to the row above packs them nearly
  // as well as libpng's search over all filters, in a third of the time.
  png_set_compression_level(png, 4);
  png_set_filter(png, 0, PNG_FILTER_UP);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width),
               static_cast<png_uint_32>(image.height), 8,
               opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  if (dpi > 0) {
    const auto per_metre = static_cast<png_uint_32>(std::lround(dpi / 0.0254));
    png_set_pHYs(png, info, per_metre, per_metre, PNG_RESOLUTION_METER);
  }
  png_write_info(png, info);
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    const std::uint8_t* from = image.rgba.data() + 4 * width * y;
    if (opaque) {
      for (std::size_t x = 0; x < width; ++x) std::copy_n(from + 4 * x, 3, row.data() + 3 * x);
    } else {
      std::copy_n(from, 4 * width, row.data());
    }
    png_write_row(png, row.data());
  }
  png_write_end(png, info);
  return out;
}

}  // namespace detail

void write_png(const Image& image, const std::filesystem::path& path, double dpi) {
  detail::write_whole(path, detail::encode_png(image, dpi));
}

void paint_png(const DisplayList& list, const std::filesystem::path& path, double dpi) {
  write_png(paint_rgba(list, dpi), path, dpi);
}

}  // namespace lagrain
