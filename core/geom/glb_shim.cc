/* glb_shim.cc: see glb_shim.h. */
#include "geom/glb_shim.h"

#include "base/error.h"
#include "geom/buffer.h"
#include "geom/draco_extra.h"
#include "geom/new_reserve.h"

#include <tiny_gltf.h>

#include <charconv>
#include <cstdio>
#include <new>
#include <ostream>
#include <streambuf>
#include <string>

namespace
{

const char *const DRACO_EXTENSION = "KHR_draco_mesh_compression";

/* More than twice what tinygltf takes for a frame, as measured. */
const size_t RESERVE_BYTES = 256 << 10, RESERVE_PATCH_BYTES = 32 << 10, RESERVE_WIDTH_BYTES = 512;

size_t reserve_bytes(const glb_frame &frame)
{
    return RESERVE_BYTES + frame.patch_count * RESERVE_PATCH_BYTES + frame.points_per_strand * RESERVE_WIDTH_BYTES;
}

/* tinygltf writes to a stream; this one ends in our buffer. */
class BufferSink : public std::streambuf
{
  public:
    BufferSink(geom_buffer *buffer, awt_error *error) : buffer_(buffer), error_(error)
    {
    }

    awt_status status() const
    {
        return status_;
    }

  protected:
    std::streamsize xsputn(const char *bytes, std::streamsize size) override
    {
        if (status_ == AWT_OK) {
            status_ = geom_buffer_append(buffer_, bytes, static_cast<size_t>(size), error_);
        }
        return status_ == AWT_OK ? size : 0;
    }

    int_type overflow(int_type c) override
    {
        char byte = traits_type::to_char_type(c);
        return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
    }

  private:
    geom_buffer *buffer_;
    awt_error *error_;
    awt_status status_ = AWT_OK;
};

tinygltf::Value whole(uint32_t number)
{
    return tinygltf::Value(static_cast<int>(number)); /* all of ours are far below 2^31 */
}

using Members = tinygltf::Value::Object;

/* Accessors without a bufferView: what they would view is in the Draco data. */
int add_accessor(tinygltf::Model *model, int type, int component_type, size_t count)
{
    tinygltf::Accessor accessor;
    accessor.type = type;
    accessor.componentType = component_type;
    accessor.count = count;
    model->accessors.push_back(accessor);
    return static_cast<int>(model->accessors.size()) - 1;
}

void add_patch(tinygltf::Model *model, tinygltf::Mesh *mesh, const glb_frame &frame, const glb_patch &patch)
{
    const glb_words words = glb_words_of(frame.kind);
    const draco_form form = frame.attributes.form;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = patch.offset;
    view.byteLength = patch.size;
    model->bufferViews.push_back(view);

    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    if (frame.kind != GEOM_GUIDES) {
        primitive.material = 0;
    }
    primitive.indices = add_accessor(model, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                                     static_cast<size_t>(patch.triangles) * 3);
    Members attributes;
    primitive.attributes["POSITION"] =
        add_accessor(model, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT, patch.vertices);
    model->accessors.back().minValues.assign(patch.min, patch.min + 3);
    model->accessors.back().maxValues.assign(patch.max, patch.max + 3);
    attributes["POSITION"] = whole(0);
    if (form != DRACO_POSITIONS) {
        primitive.attributes["_TURN"] =
            add_accessor(model, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_SHORT, patch.vertices);
        attributes["_TURN"] = whole(1);
    }

    for (uint32_t i = 0; i < DRACO_EXTRAS; i++) {
        const draco_extra_form *extra = draco_extra_at(i);
        if (frame.extra & extra->attribute) {
            primitive.attributes[extra->name] =
                add_accessor(model, extra->components == 2 ? TINYGLTF_TYPE_VEC2 : TINYGLTF_TYPE_SCALAR,
                             extra->quantised ? TINYGLTF_COMPONENT_TYPE_FLOAT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                             patch.vertices);
            attributes[extra->name] = whole(i + 1);
        }
    }

    Members draco;
    draco["bufferView"] = whole(static_cast<uint32_t>(model->bufferViews.size()) - 1);
    draco["attributes"] = tinygltf::Value(attributes);
    primitive.extensions[DRACO_EXTENSION] = tinygltf::Value(draco);
    primitive.extras =
        tinygltf::Value(Members{{words.first, whole(patch.first_strand)}, {words.lines, whole(patch.strands)}});
    mesh->primitives.push_back(primitive);
}

/* Hair is no metal, and is seen from both sides; its highlight is broad. */
tinygltf::Material make_material(const float colour[3])
{
    tinygltf::Material material;
    material.name = "hair";
    material.doubleSided = true;
    material.pbrMetallicRoughness.baseColorFactor = {colour[0], colour[1], colour[2], 1.0};
    material.pbrMetallicRoughness.metallicFactor = 0.0;
    material.pbrMetallicRoughness.roughnessFactor = 0.45;
    return material;
}

void place_node(tinygltf::Node *node, const awt_pose &head)
{
    node->name = "hair";
    node->mesh = 0;
    node->translation.assign(head.position, head.position + 3);
    node->rotation.assign(head.orientation, head.orientation + 4);
}

tinygltf::Node make_node(const glb_frame &frame)
{
    tinygltf::Node node;
    place_node(&node, frame.head);
    const glb_words words = glb_words_of(frame.kind);
    Members extras{{"kind", tinygltf::Value(std::string(words.kind))},
                   {words.lines, whole(frame.strands)},
                   {words.points, whole(frame.points_per_strand)}};
    if (frame.kind != GEOM_GUIDES) {
        extras["level"] = tinygltf::Value(std::string(glb_level_name(frame.level)));
        extras["full_strands"] = whole(frame.full_strands);
    } else {
        char binding[17];
        std::snprintf(binding, sizeof binding, "%016llx", static_cast<unsigned long long>(frame.binding));
        extras["binding"] = tinygltf::Value(std::string(binding));
        extras["turn_bits"] = whole(static_cast<uint32_t>(frame.attributes.turn_bits));
    }
    if (frame.widths) {
        tinygltf::Value::Array widths;
        for (uint32_t i = 0; i < frame.points_per_strand; i++) {
            widths.push_back(tinygltf::Value(static_cast<double>(frame.widths[i])));
        }
        extras["widths"] = tinygltf::Value(widths);
    }
    node.extras = tinygltf::Value(extras);
    return node;
}

/* Everything around one mesh of one node. */
void fill_scene(tinygltf::Model *model, int64_t time_us, const unsigned char *binary, size_t binary_size)
{
    model->asset.version = "2.0";
    model->asset.generator = "awtd";
    /* tinygltf's whole numbers have 32 bits; a double holds every microsecond of 285 years */
    model->asset.extras = tinygltf::Value(Members{{"time_us", tinygltf::Value(static_cast<double>(time_us))}});
    tinygltf::Scene scene;
    scene.nodes = {0};
    model->scenes = {scene};
    model->defaultScene = 0;
    model->buffers.resize(1);
    model->buffers[0].data.assign(binary, binary + binary_size);
}

void fill_model(tinygltf::Model *model, const glb_frame &frame)
{
    fill_scene(model, frame.time_us, frame.binary, frame.binary_size);
    model->extensionsUsed = {DRACO_EXTENSION};
    model->extensionsRequired = {DRACO_EXTENSION};
    if (frame.kind != GEOM_GUIDES) {
        model->materials = {make_material(frame.colour)};
    }

    tinygltf::Mesh mesh;
    mesh.name = "hair";
    for (uint32_t i = 0; i < frame.patch_count; i++) {
        add_patch(model, &mesh, frame, frame.patches[i]);
    }
    model->meshes = {mesh};
    model->nodes = {make_node(frame)};
}

} // namespace

awt_status glb_shim_write(const glb_frame *frame, geom_buffer *out, awt_error *error)
{
    NewReserve reserve(reserve_bytes(*frame));
    if (!reserve.is_there()) {
        return error_set(error, AWT_NO_MEMORY, nullptr);
    }
    try {
        tinygltf::Model model;
        fill_model(&model, *frame);
        BufferSink sink(out, error);
        std::ostream stream(&sink);
        tinygltf::TinyGLTF writer;
        bool written = writer.WriteGltfSceneToStream(&model, stream, false, true);
        if (sink.status() != AWT_OK) {
            return sink.status();
        }
        return written ? AWT_OK : error_set(error, AWT_BAD_VALUE, "tinygltf cannot write this frame");
    } catch (const std::bad_alloc &) {
        return error_set(error, AWT_NO_MEMORY, nullptr);
    } catch (...) {
        return error_set(error, AWT_BAD_VALUE, "tinygltf cannot write this frame");
    }
}

size_t glb_shim_print(double value, char *text, size_t size)
{
    std::to_chars_result result = std::to_chars(text, text + size, value);
    return static_cast<size_t>(result.ptr - text);
}
