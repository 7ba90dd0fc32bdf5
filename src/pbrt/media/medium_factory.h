#pragma once
#include <memory>

#include "pbrt/core/factory_table.h"
#include "pbrt/core/files.h"
#include "pbrt/math/transform.h"
#include "pbrt/media/medium.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

struct MediumContext {
    const Transform &renderFromMedium;
    const ColorSpace &colorSpace;  ///< the current one
    const FileResolver &files;
    DiagnosticSink &sink;
};

using MediumFactories = FactoryTable<std::unique_ptr<Medium>, const MediumContext>;
const MediumFactories &Media();

}  // namespace pbrt
