#include "figure.hpp"

namespace lagrain {

// One line per figure: its drawing function is declared here and defined in its own file.

FigureResult draw_figure5(const FigureOptions& options);

const std::vector<Figure>& all_figures() {
  static const std::vector<Figure> figures{
#ifdef LAGRAIN_WITH_RENDER
      {5, "Rock fall on an embankment, and its force chains", draw_figure5},
#endif
  };
  return figures;
}

}  // namespace lagrain
