#include "pbrt/shapes/mesh_sources.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <sstream>
#include <string_view>
#include <utility>

#include "pbrt/core/error.h"

namespace pbrt {
namespace {

enum class Scalar { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };
enum class Encoding { Ascii, LittleEndian, BigEndian };

struct Property {
    std::string name;
    Scalar type = Scalar::Float32;
    bool isList = false;
    Scalar countType = Scalar::Uint8;
};
struct Element {
    std::string name;
    uint64_t count = 0;
    std::vector<Property> properties;
};

size_t SizeOf(Scalar t) {
    static constexpr std::array<size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[size_t(t)];
}

using WordList = std::vector<std::string>;

WordList Words(std::string_view line) {
    std::istringstream in{std::string(line)};
    return {std::istream_iterator<std::string>(in), {}};
}

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// Reads the header, then numbers of the body.
class Reader {
  public:
    Reader(std::string_view content, const std::string &name)
        : at_(content.data()), end_(content.data() + content.size()), name_(name) {}

    std::vector<Element> ReadHeader() {
        std::string_view line;
        // The first line decides the line ending, so that a binary body may begin with any byte.
        const std::string_view content(at_, end_),
            rest = content.substr(std::min(content.find_first_of("\r\n"), content.size()));
        if (rest.starts_with('\r') && !rest.starts_with("\r\n")) lineEnd_ = '\r';
        if (!NextLine(&line) || Words(line) != WordList{"ply"})
            throw UserError("{}: is not a PLY file: the first line must be \"ply\".", name_);
        while (NextLine(&line)) {
            const WordList w = Words(line);
            if (w.empty() || w[0] == "comment" || w[0] == "obj_info") continue;
            if (w[0] == "end_header") {
                if (!hasFormat_) Fail("the header has no \"format\" line");
                ++line_;
                return std::move(elements_);
            }
            if (w[0] == "format") ReadFormat(w);
            else if (w[0] == "element") ReadElement(w);
            else if (w[0] == "property") ReadProperty(w);
            else Fail("unknown header keyword \"{}\"", w[0]);
        }
        Fail("the header has no \"end_header\" line");
    }

    void SetItem(const std::string *element, uint64_t index) {
        element_ = element;
        index_ = index;
    }
    size_t BytesLeft() const { return size_t(end_ - at_); }
    Encoding Format() const { return encoding_; }

    double Number(Scalar type) {
        if (encoding_ == Encoding::Ascii) return AsciiNumber<double>("number");
        std::array<char, 8> raw{};
        size_t size = SizeOf(type);
        if (BytesLeft() < size) Fail("the file ends too early");
        bool nativeOrder = (encoding_ == Encoding::LittleEndian) == (std::endian::native == std::endian::little);
        std::memcpy(raw.data(), at_, size);
        if (!nativeOrder) std::reverse(raw.begin(), raw.begin() + size);
        at_ += size;
        auto as = [&]<class T>(T value) {
            std::memcpy(&value, raw.data(), sizeof(T));
            return double(value);
        };
        switch (type) {
            case Scalar::Int8: return as(int8_t{});
            case Scalar::Uint8: return as(uint8_t{});
            case Scalar::Int16: return as(int16_t{});
            case Scalar::Uint16: return as(uint16_t{});
            case Scalar::Int32: return as(int32_t{});
            case Scalar::Uint32: return as(uint32_t{});
            case Scalar::Float32: return as(float{});
            case Scalar::Float64: return as(double{});
        }
        return 0;
    }
    int64_t Integer(Scalar type) {
        double v = encoding_ == Encoding::Ascii && type < Scalar::Float32 ? double(AsciiNumber<int64_t>("integer"))
                                                                          : Number(type);
        if (!(v == std::floor(v) && std::abs(v) < 9e15)) Fail("{} is not an integer", v);
        return int64_t(v);
    }

    int64_t ListLength(const Property &list) {
        const int64_t n = Integer(list.countType);
        if (n < 0) Fail("list \"{}\" has the length {}", list.name, n);
        return n;
    }
    size_t BytesAfterSpace() {
        at_ = std::find_if_not(at_, end_, IsSpace);
        return BytesLeft();
    }

    template <class... T>
    [[noreturn]] void Fail(fmt::format_string<T...> format, T &&...values) const {
        const std::string message = fmt::format(format, std::forward<T>(values)...);
        if (!element_) throw UserError("{}: line {}: {}.", name_, line_, message);
        const std::string place = fmt::format("{} {}", *element_, index_);
        if (encoding_ == Encoding::Ascii) throw UserError("{}: line {} ({}): {}.", name_, line_, place, message);
        throw UserError("{}: {}: {}.", name_, place, message);
    }

  private:
    bool NextLine(std::string_view *line) {
        if (at_ == end_) return false;
        const char *stop = std::find(at_, end_, lineEnd_);
        *line = std::string_view(at_, stop);
        at_ = stop == end_ ? end_ : stop + 1;
        ++line_;
        return true;
    }
    void ReadFormat(const WordList &w) {
        if (std::exchange(hasFormat_, true)) Fail("the format is declared twice");
        static const WordList kFormats = {"ascii", "binary_little_endian", "binary_big_endian"};
        const std::string given(w.size() > 1 ? w[1] : "");
        const auto format = std::ranges::find(kFormats, given);
        if (w.size() != 3 || format == kFormats.end())
            Fail("format \"{}\" is not known; {}", given, ListChoices(given, kFormats));
        if (w[2] != "1.0") Fail("version {} of the format is not known; only 1.0 is", w[2]);
        encoding_ = static_cast<Encoding>(format - kFormats.begin());
    }
    void ReadElement(const WordList &w) {
        Element e;
        if (w.size() != 3) Fail("an element line must read \"element <name> <count>\"");
        e.name = w[1];
        auto [end, code] = std::from_chars(w[2].data(), w[2].data() + w[2].size(), e.count);
        if (code != std::errc() || end != w[2].data() + w[2].size()) Fail("\"{}\" is not a count", w[2]);
        for (const Element &other : elements_)
            if (other.name == e.name) Fail("element \"{}\" is declared twice", e.name);
        elements_.push_back(std::move(e));
    }
    void ReadProperty(const WordList &w) {
        if (elements_.empty()) Fail("a property stands before any element");
        Property p;
        if (w.size() == 5 && w[1] == "list") {
            p.isList = true;
            p.countType = TypeOf(w[2]);
            if (p.countType >= Scalar::Float32) Fail("the length of a list must be an integer type");
            p.type = TypeOf(w[3]);
            p.name = w[4];
        } else if (w.size() == 3) {
            p.type = TypeOf(w[1]);
            p.name = w[2];
        } else {
            Fail("a property line must read \"property <type> <name>\" or \"property list <type> <type> <name>\"");
        }
        Element &e = elements_.back();
        for (const Property &other : e.properties)
            if (other.name == p.name) Fail("property \"{}\" is declared twice in element \"{}\"", p.name, e.name);
        e.properties.push_back(std::move(p));
    }
    Scalar TypeOf(const std::string &word) const {
        static const WordList kOld = {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"};
        static const WordList kNew = {"int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
        for (size_t i = 0; i < kOld.size(); ++i)
            if (word == kOld[i] || word == kNew[i]) return Scalar(i);
        Fail("unknown type \"{}\"; {}", word, ListChoices(word, kOld));
    }

    template <class T>
    T AsciiNumber(const char *kind) {
        while (at_ != end_ && IsSpace(*at_)) line_ += *at_++ == lineEnd_;
        if (at_ == end_) Fail("the file ends too early");
        const char *start = at_;
        if (*at_ == '+') ++at_;
        T value{};
        auto [stop, code] = std::from_chars(at_, end_, value);
        bool ended = stop == end_ || IsSpace(*stop);
        // from_chars leaves the value unchanged on overflow and underflow alike.
        if (!ended || (code != std::errc() && code != std::errc::result_out_of_range)) {
            const char *word = std::find_if(start, end_, IsSpace);
            Fail("\"{}\" is not a valid {}", std::string_view(start, std::min<size_t>(word - start, 40)), kind);
        }
        if (code == std::errc::result_out_of_range) {
            if constexpr (std::is_floating_point_v<T>) value = std::strtod(std::string(start, stop).c_str(), nullptr);
            else Fail("\"{}\" is too large", std::string_view(start, std::min<size_t>(stop - start, 40)));
        }
        at_ = stop;
        return value;
    }

    const char *at_, *end_;
    const std::string &name_;
    Encoding encoding_ = Encoding::Ascii;
    char lineEnd_ = '\n';
    int line_ = 0;
    bool hasFormat_ = false;
    std::vector<Element> elements_;
    const std::string *element_ = nullptr;  ///< null in the header
    uint64_t index_ = 0;
};

/// Destination of each vertex property: component 0-2 position, 3-5 normal, 6-7 uv, -1 none. The first complete pair of
/// texture coordinates in the list below is used.
std::vector<int> VertexSlots(const Element &e) {
    std::array<std::string_view, 8> names = {"x", "y", "z", "nx", "ny", "nz"};
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kPairs = {
        {{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}}};
    auto has = [&](std::string_view name) {
        return std::ranges::any_of(e.properties, [&](const Property &p) { return !p.isList && p.name == name; });
    };
    for (const auto &[u, v] : kPairs)
        if (has(u) && has(v)) {
            names[6] = u;
            names[7] = v;
            break;
        }
    std::vector<int> slots;
    for (const Property &p : e.properties) {
        const auto slot = std::find(names.begin(), names.end(), p.name);
        slots.push_back(p.isList || slot == names.end() ? -1 : int(slot - names.begin()));
    }
    return slots;
}

void SkipProperty(Reader &body, const Property &p) {
    int64_t n = p.isList ? body.ListLength(p) : 1;
    for (int64_t i = 0; i < n; ++i) body.Number(p.type);
}

/// Rejects counts that the file cannot hold, before memory is reserved.
void CheckCount(const Reader &body, const Element &e) {
    size_t minBytes = 0;
    for (const Property &p : e.properties)
        minBytes += body.Format() == Encoding::Ascii ? 2 : SizeOf(p.isList ? p.countType : p.type);
    if (minBytes > 0 && e.count > (body.BytesLeft() + 1) / minBytes)
        body.Fail("the file ends too early for {} items of element \"{}\"", e.count, e.name);
}

/// v, or zero if a component is non-finite, which `broken` counts. Normals of length zero are ignored later.
template <class T>
T Sanitized(T v, size_t *broken) {
    for (int i = 0; i < T::length(); ++i)
        if (!std::isfinite(v[i])) {
            ++*broken;
            return T(0);
        }
    return v;
}

/// Requires finite positions; returns the number of non-finite normals and uv.
size_t ReadVertices(Reader &body, const Element &e, MeshData &mesh) {
    size_t broken = 0;
    const std::vector<int> slots = VertexSlots(e);
    std::array<bool, 8> has{};
    for (int slot : slots)
        if (slot >= 0) has[slot] = true;
    if (!(has[0] && has[1] && has[2])) body.Fail("vertices need the properties x, y and z");
    bool hasNormals = has[3] && has[4] && has[5], hasUv = has[6] && has[7];
    mesh.p.resize(e.count);
    if (hasNormals) mesh.n.resize(e.count);
    if (hasUv) mesh.uv.resize(e.count);
    for (uint64_t i = 0; i < e.count; ++i) {
        body.SetItem(&e.name, i);
        std::array<Float, 8> v{};
        for (size_t k = 0; k < slots.size(); ++k) {
            if (slots[k] < 0) SkipProperty(body, e.properties[k]);
            else v[slots[k]] = Float(body.Number(e.properties[k].type));
        }
        for (size_t k = 0; k < 3; ++k)
            if (!std::isfinite(v[k]))
                body.Fail("{} is {}; positions must be finite 32-bit floats", std::string_view("xyz").substr(k, 1),
                          v[k]);
        mesh.p[i] = {v[0], v[1], v[2]};
        if (hasNormals) mesh.n[i] = Sanitized(Normal3(v[3], v[4], v[5]), &broken);
        if (hasUv) mesh.uv[i] = Sanitized(Point2(v[6], v[7]), &broken);
    }
    return broken;
}

void ReadFaces(Reader &body, const Element &e, uint64_t vertexCount, PlyMesh &mesh) {
    const Property *indices = nullptr;
    std::string names;
    for (const Property &p : e.properties) {
        if (p.isList && p.name == "vertex_indices") indices = &p;
        names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", p.name);
    }
    if (!indices)
        body.Fail("faces need a list property \"vertex_indices\"; the file has {}", names.empty() ? "none" : names);
    std::array<uint32_t, 4> corners{};
    for (uint64_t i = 0; i < e.count; ++i) {
        body.SetItem(&e.name, i);
        int64_t n = 0;
        for (const Property &p : e.properties) {
            if (&p != indices) {
                SkipProperty(body, p);
                continue;
            }
            n = body.ListLength(p);
            for (int64_t c = 0; c < n; ++c) {
                int64_t v = body.Integer(p.type);
                if (v < 0 || v >= int64_t(vertexCount))
                    body.Fail("vertex index {} is out of range; there are {} vertices", v, vertexCount);
                if (c < 4) corners[c] = uint32_t(v);
            }
        }
        if (n != 3 && n != 4) {
            ++mesh.ignoredFaces;
            continue;
        }
        MeshData &kind = n == 3 ? mesh.triangles : mesh.quads;
        if (n == 3) kind.indices.insert(kind.indices.end(), {corners[0], corners[1], corners[2]});
        else kind.indices.insert(kind.indices.end(), {corners[0], corners[1], corners[3], corners[2]});
    }
}

}  // namespace

PlyMesh ParsePly(const std::string &content, const std::string &name) {
    Reader body(content, name);
    const std::vector<Element> elements = body.ReadHeader();
    uint64_t vertexCount = 0;
    for (const Element &e : elements)
        if (e.name == "vertex") vertexCount = e.count;
    if (vertexCount == 0) throw UserError("{}: has no vertices.", name);

    PlyMesh mesh;
    MeshData vertices;
    for (const Element &e : elements) {
        body.SetItem(&e.name, 0);
        CheckCount(body, e);
        if (e.name == "vertex") {
            mesh.brokenAttributes = ReadVertices(body, e, vertices);
        } else if (e.name == "face") {
            ReadFaces(body, e, vertexCount, mesh);
        } else if (!e.properties.empty()) {
            for (uint64_t i = 0; i < e.count; ++i) {
                body.SetItem(&e.name, i);
                for (const Property &p : e.properties) SkipProperty(body, p);
            }
        }
    }
    mesh.surplusBytes = body.BytesAfterSpace();
    bool triangles = !mesh.triangles.indices.empty(), quads = !mesh.quads.indices.empty();
    if (!triangles && !quads) throw UserError("{}: has no faces with 3 or 4 corners.", name);
    auto give = [](MeshData &to, MeshData from) {
        to.p = std::move(from.p);
        to.n = std::move(from.n);
        to.uv = std::move(from.uv);
    };
    if (triangles && quads) give(mesh.triangles, vertices);
    give(quads ? mesh.quads : mesh.triangles, std::move(vertices));
    return mesh;
}

}  // namespace pbrt
