#pragma once
#include <functional>

#include "pbrt/core/factory_table.h"
#include "pbrt/textures/image_cache.h"
#include "pbrt/textures/texture_factory.h"

namespace pbrt {

/// What a texture is made from beside its parameters. The two functions resolve the textures that its parameters name.
struct TextureRequest {
    const Transform &renderFromTexture;
    SpectrumUse use;  ///< what rgb values are uplifted to; only for spectrum textures
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

/// Thrown instead of a plain UserError when an image file does not exist.
class MissingImageError : public UserError {
    using UserError::UserError;
};

/// The pyramid that the parameters of an imagemap ask for, whether or not its file exists.
MipMapKey ReadMipMapKey(const ParamSet &params, const FileResolver &files);

}  // namespace pbrt
