#include "figure.hpp"

namespace lagrain {

// One line per figure: its drawing function is declared here and defined in its own file. Without
// the renderer there are none.

#ifdef LAGRAIN_WITH_RENDER
namespace figures {
FigureResult draw_figure1(const FigureOptions& options);
FigureResult draw_figure2(const FigureOptions& options);
FigureResult draw_figure3(const FigureOptions& options);
FigureResult draw_figure4(const FigureOptions& options);
FigureResult draw_figure5(const FigureOptions& options);
FigureResult draw_figure6(const FigureOptions& options);
FigureResult draw_figure7(const FigureOptions& options);
FigureResult draw_figure8(const FigureOptions& options);
FigureResult draw_figure9(const FigureOptions& options);
}  // namespace figures
#endif

const std::vector<Figure>& all_figures() {
  static const std::vector<Figure> all{
#ifdef LAGRAIN_WITH_RENDER
      {1, "Discs and the edges of their regular triangulation", figures::draw_figure1},
      {2, "Laguerre cells, power, and the weight that finds contacts", figures::draw_figure2},
      {3, "Overlapping discs: where the detection works and where it stops", figures::draw_figure3},
      {4, "Moving discs: the triangulation before, stale, and maintained", figures::draw_figure4},
      {5, "Rock fall on an embankment, and its force chains", figures::draw_figure5},
      {6, "Packings of equal spheres under a piston", figures::draw_figure6},
      {7, "Packings of spheres of two radii", figures::draw_figure7},
      {8, "Grains leave space for a large one", figures::draw_figure8},
      {9, "Random packings and the closest one", figures::draw_figure9},
#endif
  };
  return all;
}

}  // namespace lagrain
