// read_tinygltf.cc FILE.glb...: what tinygltf, with stock libdraco inside it, makes of frames: beside each file its positions,
// primitive by primitive, as raw floats in FILE.glb.tinygltf. (Debian's own build of tinygltf is without Draco.) Exit 1 on any
// file that it does not read, or warns about.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_ENABLE_DRACO
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <fstream>
#include <iostream>

namespace
{

bool write_positions(const tinygltf::Model &model, const tinygltf::Primitive &primitive, std::ofstream *out)
{
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) {
        return false;
    }
    const tinygltf::Accessor &accessor = model.accessors[static_cast<size_t>(position->second)];
    if (accessor.bufferView < 0 || accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) {
        return false;
    }
    const tinygltf::BufferView &view = model.bufferViews[static_cast<size_t>(accessor.bufferView)];
    const std::vector<unsigned char> &data = model.buffers[static_cast<size_t>(view.buffer)].data;
    const size_t stride = static_cast<size_t>(accessor.ByteStride(view)), begin = view.byteOffset + accessor.byteOffset;
    if (accessor.count == 0 || begin + (accessor.count - 1) * stride + 12 > data.size()) {
        return false;
    }
    for (size_t i = 0; i < accessor.count; i++) {
        out->write(reinterpret_cast<const char *>(data.data() + begin + i * stride), 12);
    }
    return true;
}

bool read_file(const std::string &path)
{
    tinygltf::TinyGLTF loader;
    tinygltf::Model model;
    std::string error, warning;
    bool read = loader.LoadBinaryFromFile(&model, &error, &warning, path) && error.empty() && warning.empty();
    std::ofstream out(path + ".tinygltf", std::ios::binary);
    for (const tinygltf::Mesh &mesh : model.meshes) {
        for (const tinygltf::Primitive &primitive : mesh.primitives) {
            read = read && write_positions(model, primitive, &out);
        }
    }
    out.close();
    if (!read || model.meshes.size() != 1 || !out) {
        std::cerr << path << ": tinygltf does not read it: " << error << warning << "\n";
        return false;
    }
    return true;
}

} // namespace

int main(int argc, char **argv)
{
    bool read = argc > 1;
    for (int i = 1; i < argc; i++) {
        read = read_file(argv[i]) && read;
    }
    return read ? 0 : 1;
}
