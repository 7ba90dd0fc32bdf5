#include "pbrt/textures/texture_mapping.h"

namespace pbrt {

namespace {

/// Change of the azimuth over 2 pi with position; 0 on the axis, where it is undefined.
Vector3 AzimuthGradient(const Point3 &p) {
    Float r2 = Sqr(p.x) + Sqr(p.y);
    if (!(r2 > 0)) return Vector3(0);
    return Vector3(-p.y, p.x, 0) * (Inv2Pi / r2);
}

/// Change of the polar angle over pi with position; 0 on the axis.
Vector3 PolarGradient(const Point3 &p) {
    Float r2 = Sqr(p.x) + Sqr(p.y), r = std::sqrt(r2);
    if (!(r > 0)) return Vector3(0);
    return Vector3(p.x * p.z / r, p.y * p.z / r, -r) * (InvPi / (r2 + Sqr(p.z)));
}

}  // namespace

TexCoord2 SphericalMapping::Map(const TextureContext &ctx) const {
    TexCoord3 c = point.Map(ctx);
    Float distance = Length(c.p);
    Float theta = distance > 0 ? SafeACos(c.p.z / distance) : 0;
    Float phi = std::atan2(c.p.y, c.p.x);
    if (phi < 0) phi += 2 * Pi;
    // Stock pbrt-v4 hands out the azimuth's change as that of s and the polar angle's as that of t, crosswise to the
    // coordinates. Only the width of filters depends on it; kept so that pictures agree.
    Vector3 ds = AzimuthGradient(c.p), dt = PolarGradient(c.p);
    return {{theta * InvPi, phi * Inv2Pi}, Dot(ds, c.dpdx), Dot(ds, c.dpdy), Dot(dt, c.dpdx), Dot(dt, c.dpdy)};
}

TexCoord2 CylindricalMapping::Map(const TextureContext &ctx) const {
    TexCoord3 c = point.Map(ctx);
    Vector3 ds = AzimuthGradient(c.p);
    return {{(Pi + std::atan2(c.p.y, c.p.x)) * Inv2Pi, c.p.z}, Dot(ds, c.dpdx), Dot(ds, c.dpdy), c.dpdx.z, c.dpdy.z};
}

TexCoord2 PlanarMapping::Map(const TextureContext &ctx) const {
    TexCoord3 c = point.Map(ctx);
    return {{du + Dot(c.p, vs), dv + Dot(c.p, vt)}, Dot(vs, c.dpdx), Dot(vs, c.dpdy), Dot(vt, c.dpdx), Dot(vt, c.dpdy)};
}

Vector3 ReadVector3(const ParamSet &params, std::string_view name, const Vector3 &defaultValue) {
    const Param *p = params.Find(name, ParamType::Vector3);
    if (!p) return defaultValue;
    if (p->floats.size() != 3)
        throw UserError(fmt::format("{}: \"vector3 {}\" takes three values, found {}.", params.What(), name,
                                    p->floats.size()),
                        p->loc);
    return {p->floats[0], p->floats[1], p->floats[2]};
}

TextureMapping2D ReadTextureMapping2D(const ParamSet &params, const Transform &renderFromTexture,
                                      DiagnosticSink &sink) {
    static const std::vector<std::string> kMappings = {"uv", "spherical", "cylindrical", "planar"};
    std::string name = params.GetString("mapping", "uv");
    if (name != "uv" && renderFromTexture.IsSingular())
        throw UserError(fmt::format("{}: mapping \"{}\" needs a transformation that can be inverted.", params.What(),
                                    name),
                        params.Loc());
    if (name == "uv")
        return UvMapping{params.GetFloat("uscale", 1), params.GetFloat("vscale", 1), params.GetFloat("udelta", 0),
                         params.GetFloat("vdelta", 0)};
    if (name == "spherical") return SphericalMapping{PointMapping(renderFromTexture)};
    if (name == "cylindrical") return CylindricalMapping{PointMapping(renderFromTexture)};
    if (name == "planar")
        return PlanarMapping{PointMapping(renderFromTexture), ReadVector3(params, "v1", {1, 0, 0}),
                             ReadVector3(params, "v2", {0, 1, 0}), params.GetFloat("udelta", 0),
                             params.GetFloat("vdelta", 0)};
    sink.Warning(params.LocOf("mapping"), fmt::format("{}: unknown mapping \"{}\", \"uv\" is used; {}.", params.What(),
                                                      name, ListChoices(name, kMappings)));
    return UvMapping{};
}

}  // namespace pbrt
