#include <lagrain/paint.hpp>

int main() {
  lagrain::DisplayList list{.width = 20, .height = 20};
  list.add(lagrain::Disc{.centre = {10, 10}, .radius = 5, .fill = {0, 0, 0, 255}});

  lagrain::paint_pdf(list, "disc.pdf");
  return lagrain::paint_rgba(list, 72).width == 20 ? 0 : 1;
}
