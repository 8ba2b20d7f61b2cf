// A PLC for the tests: compiles Structured Text with pyplcopen's headers and runs the scans of a program.
// Flags are 0 and 1, whole numbers are doubles, REAL is rounded to 32 bits on the way in.
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "axis/state.h"
#include "st/compile.h"
#include "st/vm.h"

namespace st = plcopen::core::st;

namespace
{

struct Machine
{
    st::CompileResult compiled;
    std::vector<std::uint64_t> storage;
    st::Instance instance;

    bool load()
    {
        storage.assign(compiled.program.required_bytes() / 8 + 2, 0);
        return instance.load(compiled.program, reinterpret_cast<unsigned char *>(storage.data()),
                             storage.size() * sizeof(std::uint64_t), 1000000) == plcopen::core::rt::ErrorCode::ok;
    }

    void write(const st::VarInfo &variable, double value)
    {
        unsigned char *place = reinterpret_cast<unsigned char *>(storage.data()) + variable.offset;
        const float real = static_cast<float>(value);
        const std::int32_t whole = variable.type == st::Type::dint ? static_cast<std::int32_t>(value) : 0;
        switch(variable.type) {
        case st::Type::bool_: *place = value != 0.0; break;
        case st::Type::dint: std::memcpy(place, &whole, sizeof(whole)); break;
        case st::Type::real: std::memcpy(place, &real, sizeof(real)); break;
        default: std::memcpy(place, &value, sizeof(value));
        }
    }

    double read(int index) const
    {
        const st::Type type = compiled.program.vars[index].type;
        const bool floating = type == st::Type::real || type == st::Type::lreal;
        return floating ? instance.value_f64(index) : static_cast<double>(instance.value_i64(index));
    }
};

} // namespace

extern "C" {

// Compiles and loads; 0 and the diagnostics in `message` where that fails.
void *plc_load(const char *source, char *message, int room)
{
    st::CompileOptions options;
    options.max_parameters_per_pou = 512;
    Machine *machine = new Machine{st::compile(source, options), {}, {}};
    std::string text;
    for(const st::Diagnostic &diagnostic : machine->compiled.diagnostics) {
        text += "line " + std::to_string(diagnostic.line) + ": " + st::to_string(diagnostic.code) + " " +
                diagnostic.message + "\n";
    }
    bool good = machine->compiled.ok;
    if(good) {
        good = machine->load();
        if(!good) text += "load failed";
    }
    std::snprintf(message, static_cast<std::size_t>(room), "%s", text.c_str());
    if(good) return machine;
    delete machine;
    return nullptr;
}

void plc_free(void *handle) { delete static_cast<Machine *>(handle); }

int plc_find(void *handle, const char *name) { return static_cast<Machine *>(handle)->instance.find(name); }

// Starts anew where `cold` says so, writes a row of `in`, scans, reads a row of `out`, `rows` times; returns the row
// that failed, or `rows`.
int plc_run(void *handle, int rows, const double *cold, int columns_in, const int *where_in,
            const double *in, int columns_out, const int *where_out, double *out)
{
    Machine &machine = *static_cast<Machine *>(handle);
    const std::vector<st::VarInfo> &variables = machine.compiled.program.vars;
    for(int row = 0; row < rows; ++row) {
        if(cold[row] != 0.0 && !machine.load()) return row;
        for(int column = 0; column < columns_in; ++column)
            machine.write(variables[where_in[column]], in[row * columns_in + column]);
        if(machine.instance.scan(1000000) != st::ScanError::ok) return row;
        for(int column = 0; column < columns_out; ++column)
            out[row * columns_out + column] = machine.read(where_out[column]);
    }
    return rows;
}
}
