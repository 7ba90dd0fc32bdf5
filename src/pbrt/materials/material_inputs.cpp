#include "pbrt/materials/material_inputs.h"

namespace pbrt {

namespace {

FloatInput ReadDirection(const ParamSet &params, TextureLibrary &textures, const std::string &prefix,
                         const std::string &name) {
    FloatTexturePtr own = textures.GetFloatOrNull(params, prefix + name);
    return FloatInput(own ? own : textures.GetFloat(params, prefix + "roughness", 0));
}

}  // namespace

RoughnessInput::RoughnessInput(const ParamSet &params, TextureLibrary &textures, const std::string &prefix, bool remap)
    : u_(ReadDirection(params, textures, prefix, "uroughness")),
      v_(ReadDirection(params, textures, prefix, "vroughness")), remap_(remap) {
    if (u_.IsConstant() && v_.IsConstant()) constant_ = Distribution(u_({}), v_({}));
}

}  // namespace pbrt
