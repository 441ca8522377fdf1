#include <lagrain/compiled_kernels.hpp>

namespace lagrain {

template class ContactKernel<2, CundallStrack<LinearSpring>>;
template class ContactKernel<2, CundallStrack<Hertz>>;
template class ContactKernel<3, CundallStrack<LinearSpring>>;
template class ContactKernel<3, CundallStrack<Hertz>>;

}  // namespace lagrain
