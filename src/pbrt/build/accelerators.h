#pragma once
#include <variant>

#include "pbrt/core/factory_table.h"

namespace pbrt {

struct AcceleratorContext {
    DiagnosticSink &sink;
};
/// The accelerator is always Embree; the parameters of stock's accelerators are validated only.
using AcceleratorTable = FactoryTable<std::monostate, const AcceleratorContext>;
const AcceleratorTable &Accelerators();

}  // namespace pbrt
