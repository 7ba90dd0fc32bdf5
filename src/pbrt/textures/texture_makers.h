#pragma once
#include <functional>

#include "pbrt/textures/image_cache.h"
#include "pbrt/textures/texture_factory.h"

namespace pbrt {

/// What a texture class needs to be made: its parameters, and who resolves the textures they name.
struct TextureRequest {
    const std::string &textureClass;
    const ParamSet &params;
    const Transform &renderFromTexture;
    const FileResolver &files;
    ImageCache &images;
    DiagnosticSink &sink;
    std::function<FloatTexturePtr(const std::string &name, Float defaultValue)> floatTexture;
    std::function<SpectrumTexturePtr(const std::string &name, SpectrumPtr defaultValue)> spectrumTexture;
};

/// Thrown instead of a plain UserError when an image file does not exist.
class MissingImageError : public UserError {
    using UserError::UserError;
};

/// One of SupportedTextures(). Throws UserError.
FloatTexturePtr MakeFloatTexture(const TextureRequest &request);
SpectrumTexturePtr MakeSpectrumTexture(const TextureRequest &request, SpectrumUse use);

/// The pyramid an imagemap asks for, whether or not its file exists.
MipMapKey ReadMipMapKey(const ParamSet &params, const FileResolver &files);

}  // namespace pbrt
