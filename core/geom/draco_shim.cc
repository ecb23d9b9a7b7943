/* draco_shim.cc: see draco_shim.h. */
#include "geom/draco_shim.h"

#include "base/error.h"
#include "geom/buffer.h"

#include <draco/compression/expert_encode.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/quantization_utils.h>
#include <draco/core/varint_decoding.h>
#include <draco/core/varint_encoding.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

namespace
{

/* "DRACO", bitstream 2.2, triangular mesh, sequential, no flags: what libdraco 1.3 to 1.5 write. */
const unsigned char MESH_HEADER[] = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, 0, 0, 0};
/* One attributes decoder, one attribute: position, float32, 3 components, not normalised, unique id 0, quantised. */
const unsigned char POSITION_HEADER[] = {1, 1, 0, 9, 3, 0, 0, 2};
/* Draco's own coder never has more symbols (18 bits); a hostile table would make it allocate 800 bytes a byte. */
const uint32_t MAX_SYMBOLS = 1u << 18;

/* ---- encoding */

void fill_mesh(draco::Mesh *mesh, const float *positions, uint32_t vertices, const uint16_t *indices,
               uint32_t triangles)
{
    mesh->set_num_points(vertices);
    mesh->SetNumFaces(triangles);
    for (uint32_t i = 0; i < triangles; i++) {
        mesh->SetFace(draco::FaceIndex(i), {draco::PointIndex(indices[3 * i]), draco::PointIndex(indices[3 * i + 1]),
                                            draco::PointIndex(indices[3 * i + 2])});
    }
    draco::GeometryAttribute kind;
    kind.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 3 * sizeof(float), 0);
    int id = mesh->AddAttribute(kind, true, vertices);
    mesh->attribute(id)->buffer()->Write(0, positions, (size_t)vertices * 3 * sizeof(float));
}

bool encode_mesh(const draco::Mesh &mesh, const draco_box &box, draco::EncoderBuffer *out)
{
    draco::ExpertEncoder encoder(mesh);
    encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
    encoder.SetSpeedOptions(10, 10);
    encoder.SetAttributeExplicitQuantization(0, box.bits, 3, box.origin, box.range);
    encoder.options().SetGlobalBool("compress_connectivity", true);
    return encoder.EncodeToBuffer(out).ok();
}

/* Decoders refuse a mesh with more triangles than a third of the bytes that follow its two counts, though compressed
 * triangles may need far less. They take trailing zeros, which cost 3 bytes a triangle at most where raw triangles
 * would cost 6 and come on top of the positions. */
size_t least_size(uint32_t triangles, uint32_t vertices)
{
    draco::EncoderBuffer counts;
    draco::EncodeVarint(triangles, &counts);
    draco::EncodeVarint(vertices, &counts);
    return sizeof MESH_HEADER + counts.size() + (size_t)triangles * 3;
}

/* ---- decoding */

/* Whether the entropy-coded symbols that begin here announce a table of a believable size. */
bool symbols_believable(draco::DecoderBuffer here)
{
    uint8_t scheme, bits;
    uint32_t symbols;
    if (!here.Decode(&scheme) || scheme > draco::SYMBOL_CODING_RAW) {
        return false;
    }
    if (scheme == draco::SYMBOL_CODING_RAW && !here.Decode(&bits)) {
        return false;
    }
    return draco::DecodeVarint(&symbols, &here) && symbols <= MAX_SYMBOLS;
}

/* Stock decoder that looks ahead: at the counts before the connectivity is read, and at the attribute's description
 * before anything is allocated by it. */
class CheckedDecoder : public draco::MeshSequentialDecoder
{
  public:
    CheckedDecoder(uint32_t vertices, uint32_t triangles) : vertices_(vertices), triangles_(triangles)
    {
    }

  protected:
    bool DecodeConnectivity() override
    {
        return counts_as_expected(*buffer()) && MeshSequentialDecoder::DecodeConnectivity() &&
               attribute_as_expected(*buffer());
    }

  private:
    bool counts_as_expected(draco::DecoderBuffer here) const
    {
        uint32_t triangles, vertices;
        uint8_t raw;
        return draco::DecodeVarint(&triangles, &here) && triangles == triangles_ &&
               draco::DecodeVarint(&vertices, &here) && vertices == vertices_ && here.Decode(&raw) &&
               (raw || symbols_believable(here));
    }

    static bool attribute_as_expected(draco::DecoderBuffer here)
    {
        unsigned char description[sizeof POSITION_HEADER];
        int8_t prediction, transform;
        uint8_t compressed;
        if (!here.Decode(description, sizeof description) ||
            std::memcmp(description, POSITION_HEADER, sizeof description) != 0 || !here.Decode(&prediction)) {
            return false;
        }
        if (prediction != draco::PREDICTION_NONE &&
            (prediction != draco::PREDICTION_DIFFERENCE || !here.Decode(&transform))) {
            return false;
        }
        return here.Decode(&compressed) && (!compressed || symbols_believable(here));
    }

    uint32_t vertices_, triangles_;
};

bool same_triangles(const draco::Mesh &mesh, const uint16_t *indices, uint32_t triangles)
{
    if (mesh.num_faces() != triangles) {
        return false;
    }
    for (uint32_t i = 0; i < triangles; i++) {
        const draco::Mesh::Face &face = mesh.face(draco::FaceIndex(i));
        for (uint32_t k = 0; k < 3; k++) {
            if (face[k].value() != indices[3 * i + k]) {
                return false;
            }
        }
    }
    return true;
}

bool copy_positions(const draco::Mesh &mesh, uint32_t vertices, float *positions)
{
    const draco::PointAttribute *attribute = mesh.num_attributes() == 1 ? mesh.attribute(0) : nullptr;
    const size_t wanted = (size_t)vertices * 3 * sizeof(float);
    if (!attribute || mesh.num_points() != vertices || attribute->size() != vertices ||
        !attribute->is_mapping_identity() || attribute->buffer()->data_size() < wanted) {
        return false;
    }
    std::memcpy(positions, attribute->buffer()->data(), wanted);
    return true;
}

awt_status refuse(awt_error *error)
{
    return error_set(error, AWT_BAD_FORMAT, "a patch's Draco data is not a mesh that awtd wrote");
}

} // namespace

float draco_shim_round(const draco_box *box, int axis, float value)
{
    const int32_t greatest = (1 << box->bits) - 1;
    draco::Quantizer quantizer;
    draco::Dequantizer dequantizer;
    quantizer.Init(box->range, greatest);
    dequantizer.Init(box->range, greatest);
    return dequantizer(quantizer(value - box->origin[axis])) + box->origin[axis];
}

awt_status draco_shim_encode(const draco_box *box, const float *positions, uint32_t vertices, const uint16_t *indices,
                             uint32_t triangles, geom_buffer *out, awt_error *error)
{
    try {
        draco::Mesh mesh;
        draco::EncoderBuffer encoded;
        fill_mesh(&mesh, positions, vertices, indices, triangles);
        if (!encode_mesh(mesh, *box, &encoded)) {
            return error_set(error, AWT_BAD_VALUE, "libdraco cannot encode these strands");
        }
        encoded.buffer()->resize(std::max(encoded.size(), least_size(triangles, vertices)));
        return geom_buffer_append(out, encoded.data(), encoded.size(), error);
    } catch (const std::bad_alloc &) {
        return error_set(error, AWT_NO_MEMORY, nullptr);
    } catch (...) {
        return error_set(error, AWT_BAD_VALUE, "libdraco cannot encode these strands");
    }
}

awt_status draco_shim_decode(const void *bytes, size_t size, const uint16_t *indices, uint32_t vertices,
                             uint32_t triangles, float *positions, awt_error *error)
{
    if (size < sizeof MESH_HEADER || std::memcmp(bytes, MESH_HEADER, sizeof MESH_HEADER) != 0) {
        return refuse(error);
    }
    try {
        draco::DecoderBuffer buffer;
        buffer.Init(static_cast<const char *>(bytes), size);
        draco::Mesh mesh;
        CheckedDecoder decoder(vertices, triangles);
        if (!decoder.Decode(draco::DecoderOptions(), &buffer, &mesh).ok() ||
            !same_triangles(mesh, indices, triangles) || !copy_positions(mesh, vertices, positions)) {
            return refuse(error);
        }
    } catch (const std::bad_alloc &) {
        return error_set(error, AWT_NO_MEMORY, nullptr);
    } catch (...) {
        return refuse(error);
    }
    for (size_t i = 0; i < (size_t)vertices * 3; i++) {
        if (!std::isfinite(positions[i])) {
            return error_set(error, AWT_BAD_VALUE, "a patch holds a position that is not a finite number");
        }
    }
    return AWT_OK;
}
