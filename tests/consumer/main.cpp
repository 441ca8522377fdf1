#include <lagrain/restitution.hpp>
#include <lagrain/vec.hpp>

int main() {
  return lagrain::Vec<2>{3.0, 4.0}.norm() == 5.0 ? 0 : 1;
}
