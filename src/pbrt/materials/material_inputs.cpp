#include "pbrt/materials/material_inputs.h"

namespace pbrt {

namespace {

FloatInput ReadDirection(const ParamSet &params, TextureLibrary &textures, const std::string &prefix,
                         const std::string &name) {
    std::string given = prefix + name;
    FloatTexturePtr texture = textures.GetFloatOrNull(params, given);
    if (!texture) texture = textures.GetFloat(params, given = prefix + "roughness", 0);
    if (auto constant = texture->Constant()) params.Require<Float>(given, *constant, {0, 1e6f});
    return FloatInput(std::move(texture));
}

}  // namespace

RoughnessInput::RoughnessInput(const ParamSet &params, TextureLibrary &textures, const std::string &prefix, bool remap)
    : u_(ReadDirection(params, textures, prefix, "uroughness")),
      v_(ReadDirection(params, textures, prefix, "vroughness")), remap_(remap) {
    if (u_.IsConstant() && v_.IsConstant()) constant_ = Distribution(u_({}), v_({}));
}

}  // namespace pbrt
