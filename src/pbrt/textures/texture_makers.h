#pragma once
#include <functional>

#include "pbrt/core/factory_table.h"
#include "pbrt/textures/image_texture.h"
#include "pbrt/textures/texture_factory.h"

namespace pbrt {

/// Context of texture creation besides its parameters. The two functions resolve operand textures.
struct TextureRequest {
    const Transform &renderFromTexture;
    SpectrumUse use;  ///< uplifting of rgb values; only for spectrum textures
    const FileResolver &files;
    ImageCache &images;
    DiagnosticSink &sink;
    std::function<FloatTexturePtr(const FloatTextureParam &)> floatTexture;
    std::function<SpectrumTexturePtr(const SpectrumTextureParam &)> spectrumTexture;
};

using FloatTextureTable = FactoryTable<FloatTexturePtr, const TextureRequest>;
using SpectrumTextureTable = FactoryTable<SpectrumTexturePtr, const TextureRequest>;
const FloatTextureTable &FloatTextures();
const SpectrumTextureTable &SpectrumTextures();

/// Thrown instead of UserError when an image file does not exist.
class MissingImageError : public UserError {
    using UserError::UserError;
};

/// Pyramid key of an imagemap's parameters, whether or not its file exists.
MipMapKey ReadMipMapKey(const ParamSet &params, const FileResolver &files);

}  // namespace pbrt
