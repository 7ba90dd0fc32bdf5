#pragma once
#include <variant>

#include "pbrt/core/factory_table.h"

namespace pbrt {

struct AcceleratorContext {
    DiagnosticSink &sink;
};
/// The acceleration structure is always Embree's; the parameters of stock's structures are only checked.
using AcceleratorTable = FactoryTable<std::monostate, const AcceleratorContext>;
const AcceleratorTable &Accelerators();

}  // namespace pbrt
