#include <lagrain/compiled_kernels.hpp>

namespace lagrain {

template class ContactKernel<2, ViscousFriction<LinearSpring>>;
template class ContactKernel<2, ViscousFriction<Hertz>>;
template class ContactKernel<3, ViscousFriction<LinearSpring>>;
template class ContactKernel<3, ViscousFriction<Hertz>>;

}  // namespace lagrain
