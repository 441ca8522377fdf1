// SPDX-License-Identifier: GPL-3.0-or-later
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
FigureResult draw_figure10(const FigureOptions& options);
FigureResult draw_figure11(const FigureOptions& options);
FigureResult draw_figure12(const FigureOptions& options);
FigureResult draw_figure13(const FigureOptions& options);
FigureResult draw_figure14(const FigureOptions& options);
FigureResult draw_figure15(const FigureOptions& options);
FigureResult draw_figure16(const FigureOptions& options);
FigureResult draw_figure17(const FigureOptions& options);
FigureResult draw_figure18(const FigureOptions& options);
FigureResult draw_figure19(const FigureOptions& options);
FigureResult draw_figure20(const FigureOptions& options);
FigureResult draw_figure21(const FigureOptions& options);
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
      {10, "Integrators and steps", figures::draw_figure10, Page::report},
      {11, "Contact laws and the rigid limit", figures::draw_figure11, Page::report},
      {12, "Neighbourhoods: what is missed, what it costs", figures::draw_figure12, Page::report},
      {13, "Predicates: what plain doubles get wrong", figures::draw_figure13, Page::report},
      {14, "Triangulation update: flips against rebuild", figures::draw_figure14, Page::report},
      {15, "What each piece of physics costs", figures::draw_figure15, Page::report},
#ifdef LAGRAIN_WITH_BOX2D
      {16, "Box2D and lagrain against closed forms", figures::draw_figure16, Page::report},
      {17, "Box2D and lagrain in bulk", figures::draw_figure17, Page::report},
#endif
      {18, "Hard cases", figures::draw_figure18, Page::report},
      {19, "Impacts of one and two spheres", figures::draw_figure19, Page::report},
      {20, "Bulk processes: silo, drum, penetration", figures::draw_figure20, Page::report},
      {21, "Janssen's silo, angle of repose, biaxial test", figures::draw_figure21, Page::report},
#endif
  };
  return all;
}

}  // namespace lagrain
