#include <lagrain/compiled_kernels.hpp>

namespace lagrain {

template class ContactKernel<2, LinearSpring>;
template class ContactKernel<2, Hertz>;
template class ContactKernel<3, LinearSpring>;
template class ContactKernel<3, Hertz>;

}  // namespace lagrain
