#pragma once
#include <variant>

#include "pbrt/core/params.h"
#include "pbrt/math/transform.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// Texture coordinates and how they change by one pixel step in x and y.
struct TexCoord2 {
    Point2 st{};
    Float dsdx = 0, dsdy = 0, dtdx = 0, dtdy = 0;
};
struct TexCoord3 {
    Point3 p{};
    Vector3 dpdx{}, dpdy{};
};

/// The surface's own parameters, scaled and shifted.
struct UvMapping {
    Float su = 1, sv = 1, du = 0, dv = 0;
    TexCoord2 Map(const TextureContext &ctx) const {
        return {{su * ctx.uv.x + du, sv * ctx.uv.y + dv}, su * ctx.dudx, su * ctx.dudy, sv * ctx.dvdx, sv * ctx.dvdy};
    }
};

/// Position in texture space.
struct PointMapping {
    explicit PointMapping(const Transform &renderFromTexture) : textureFromRender(renderFromTexture.Inverse()) {}
    Transform textureFromRender;
    TexCoord3 Map(const TextureContext &ctx) const {
        return {textureFromRender.Point(ctx.p), textureFromRender.Vector(ctx.dpdx), textureFromRender.Vector(ctx.dpdy)};
    }
};

/// (theta / pi, phi / 2 pi) seen from the origin of texture space.
struct SphericalMapping {
    PointMapping point;
    TexCoord2 Map(const TextureContext &ctx) const;
};

/// ((pi + atan2(y, x)) / 2 pi, z).
struct CylindricalMapping {
    PointMapping point;
    TexCoord2 Map(const TextureContext &ctx) const;
};

/// (du + p.vs, dv + p.vt).
struct PlanarMapping {
    PointMapping point;
    Vector3 vs{1, 0, 0}, vt{0, 1, 0};
    Float du = 0, dv = 0;
    TexCoord2 Map(const TextureContext &ctx) const;
};

using TextureMapping2D = std::variant<UvMapping, SphericalMapping, CylindricalMapping, PlanarMapping>;

inline TexCoord2 Map(const TextureMapping2D &mapping, const TextureContext &ctx) {
    if (const UvMapping *uv = std::get_if<UvMapping>(&mapping)) [[likely]] return uv->Map(ctx);
    return std::visit([&](const auto &m) { return m.Map(ctx); }, mapping);
}

/// The `mapping` parameter and what belongs to it (pbrt-v4-format §8). An unknown name is a warning and means "uv",
/// as in stock pbrt-v4.
TextureMapping2D ReadTextureMapping2D(const ParamSet &params, const Transform &renderFromTexture, DiagnosticSink &sink);

/// A single vector3 parameter.
Vector3 ReadVector3(const ParamSet &params, std::string_view name, const Vector3 &defaultValue);

}  // namespace pbrt
