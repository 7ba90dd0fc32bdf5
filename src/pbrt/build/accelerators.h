#pragma once
#include <variant>

#include "pbrt/core/factory_table.h"

namespace pbrt {

struct AcceleratorContext {
    DiagnosticSink &sink;
};
/// The acceleration structure is always Embree's; what the scene says about stock's own is only checked.
using AcceleratorTable = FactoryTable<std::monostate, const AcceleratorContext>;
const AcceleratorTable &Accelerators();

}  // namespace pbrt
