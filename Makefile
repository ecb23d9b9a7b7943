# awtd: hair simulation as a service. `make help` says what there is.
config ?= release
CC ?= cc
CXX ?= c++
B := build/$(config)
Q := $(if $(V),,@)
, := ,

FLAGS_debug := -O0 -g
FLAGS_release := -O2 -g
FLAGS_asan := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
# With clang its objects also serve libFuzzer in make test: counters alone cost little, and save a build.
FLAGS_asan += $(if $(findstring clang,$(CC)),-fsanitize-coverage=inline-8bit-counters$(,)pc-table)
FLAGS_tsan := -O1 -g -fsanitize=thread -fno-omit-frame-pointer
FLAGS_fuzz := -O1 -g -fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=all -fno-omit-frame-pointer
FLAGS_coverage := -O0 -g --coverage
FLAGS := $(FLAGS_$(config)) $(if $(native),-O3 -march=native)
$(if $(FLAGS_$(config)),,$(error config is one of debug release asan tsan coverage fuzz, not "$(config)"))

# Same bits everywhere: no contraction of a*b+c, no reassociation. (Without errno a square root is one instruction.)
# gcc 12.2 contracts all the same where it vectorises straight code whose signs alternate, as in quat_mul (its bug 107647):
# tests/soak.sh looks at the instructions.
WARN := -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror
CFLAGS_ALL := -std=c17 -D_POSIX_C_SOURCE=200809L -ffp-contract=off -fno-tree-slp-vectorize -fno-math-errno $(WARN) -Wmissing-prototypes -pthread $(FLAGS) $(CFLAGS)
CXXFLAGS_ALL := -std=c++17 -ffp-contract=off -fno-tree-slp-vectorize -fno-math-errno $(WARN) -pthread $(FLAGS) $(CXXFLAGS)
LDLIBS_ALL := -ltinygltf -ldraco -lm -pthread $(LDLIBS)

# Who may include what (the header table of the house): each room sees only these folders.
INC_core := -Icore
INC_proto := -Iproto
INC_server := -Iserver -Icore -Iproto
INC_clients := -Iclients -Icore -Iproto
INC_tests := -Itests -Iserver -Iclients -Icore -Iproto -I$(B)

SRC_core := $(wildcard core/*/*.c core/*/*.cc)
SRC_proto := $(wildcard proto/*.c)
SRC_server := $(wildcard server/*.c)
SRC_clients := $(filter-out clients/awtctl% clients/engine_% clients/load/% clients/web/%,$(wildcard clients/*.c clients/*/*.c))
SRC_awtctl := $(wildcard clients/awtctl*.c)
SRC_load := $(wildcard clients/load/*.c)
SRC_loop := $(wildcard clients/engine_*.c)
SRC_unit := tests/main.c $(wildcard tests/unit/*.c tests/unit/*.cc tests/e2e/*.c)
SRC_bench := $(wildcard tests/bench/*.c)
SRC_relay := $(wildcard tests/relay/*.c)
# What tests look into of programs that are no library.
SRC_lent := tests/relay/lane.c $(filter-out clients/load/awt_load.c,$(SRC_load))
SRC_fuzz := $(wildcard tests/fuzz/*.c)
HEADERS := $(wildcard $(foreach r,core proto server clients tests,$(r)/*.h $(r)/*/*.h))
SRC_ALL := $(SRC_core) $(SRC_proto) $(SRC_server) $(SRC_clients) $(SRC_awtctl) $(SRC_load) $(SRC_loop) $(SRC_unit) $(SRC_bench) $(SRC_relay) $(SRC_fuzz)

objects = $(patsubst %,$(B)/obj/%.o,$(1))
LIBAWT := $(B)/libawt.a
LIBPROTO := $(B)/libawtproto.a
LIBCLIENT := $(B)/libawtclient.a
LIBSERVER := $(B)/libawtserver.a
PROGRAMS := $(B)/awtd $(B)/awtctl $(B)/awt-load $(B)/awt-bench $(B)/engine_loop

.PHONY: all help demo web viewer test soak sheets pictures bench bench-service format lint install clean deps deps-test deps-viewer deps-soak programs tests-binary
.DELETE_ON_ERROR:

all: programs $(B)/rooms.ok

programs: $(PROGRAMS)
ifeq ($(config),release)
	@ln -sf release/awtd release/awtctl release/awt-load release/awt-bench build/
endif

tests-binary: $(B)/tests $(B)/awt-relay $(PROGRAMS) $(if $(filter asan,$(config)),$(if $(findstring clang,$(CC)),$(B)/fuzz))

help:
	@echo 'make demo      installs what is missing, builds, plays a leaning head for 10 s, leaves GLB files in build/demo'
	@echo '               GROOM=FILE MOTION=FILE JOINT=NAME SCALE=S UP=y|z HEAD=x,y,z,r: your own hair and motion'
	@echo 'make viewer    installs what is missing, builds, and shows hair in your browser: prints the address to open'
	@echo 'make test      installs what is missing, builds, runs every test (DEPS=never: installs nothing)'
	@echo 'make soak      the long tests (about half an hour on two cores): minutes of violent motion, TSan, same bits, fuzzing; PARTS=bits: that alone'
	@echo 'make sheets    the pictures of README.md: every style (and real groom that is there) through the lean'
	@echo 'make pictures  the pictures of the viewer in README.md, drawn in Chromium'
	@echo 'make all       builds; config=debug|release|asan|tsan|coverage|fuzz, native=1, CC=clang CXX=clang++, V=1'
	@echo 'make bench-service  loads awtd and a bare poll() server in turns, and compares them with the aims (about ten minutes)'
	@echo 'make bench format lint install clean'

$(B)/awtd: $(B)/obj/server/main.c.o $(LIBSERVER) $(LIBAWT) $(LIBPROTO)
$(B)/awtctl: $(call objects,$(SRC_awtctl)) $(LIBCLIENT) $(LIBAWT) $(LIBPROTO)
# A game's loop with hair, to be copied from.
$(B)/engine_loop: $(call objects,$(SRC_loop)) $(LIBCLIENT) $(LIBAWT) $(LIBPROTO)
$(B)/awt-load: $(call objects,$(SRC_load)) $(LIBCLIENT) $(LIBAWT) $(LIBPROTO)
$(B)/awt-bench: $(call objects,$(SRC_bench)) $(LIBSERVER) $(LIBCLIENT) $(LIBAWT) $(LIBPROTO)
$(B)/tests: $(call objects,$(SRC_unit) $(SRC_lent)) $(LIBSERVER) $(LIBCLIENT) $(LIBAWT) $(LIBPROTO)
# The tests see what the heap is asked for, and can refuse it, and what clocks are: the linker leads these calls to
# tests/unit/heap_seam.c and clock_seam.c.
$(B)/tests: WRAP := $(addprefix -Wl$(,)--wrap=,malloc calloc realloc aligned_alloc posix_memalign free clock_gettime time)
# A bad line for the tests to put between client and daemon.
$(B)/awt-relay: $(call objects,$(SRC_relay)) $(LIBAWT)
# What reads bytes from outside, under libFuzzer: config=asan or, slower and keener, config=fuzz; CC=clang CXX=clang++
# (tests/fuzz/suite.sh and tests/soak.sh run it).
$(B)/fuzz: $(call objects,$(SRC_fuzz) $(addprefix tests/unit/,proto_fill.c server_fixture.c interleaving.c interleaving_actor.c interleaving_opens.c interleaving_says.c hair_file.c)) $(LIBSERVER) $(LIBCLIENT) $(LIBAWT) $(LIBPROTO)
$(B)/fuzz: WRAP := -fsanitize=fuzzer
$(PROGRAMS) $(B)/tests $(B)/awt-relay $(B)/fuzz:
	@echo "  LD   $@"
	$(Q)$(CXX) $(FLAGS) $(WRAP) $(LDFLAGS) -o $@ $^ $(LDLIBS_ALL)

$(LIBAWT): $(call objects,$(SRC_core))
$(LIBPROTO): $(call objects,$(SRC_proto))
$(LIBCLIENT): $(call objects,$(SRC_clients))
$(LIBSERVER): $(call objects,$(filter-out server/main.c,$(SRC_server)))
$(LIBAWT) $(LIBPROTO) $(LIBCLIENT) $(LIBSERVER):
	@echo "  AR   $@"
	@rm -f $@
	$(Q)$(AR) rcs $@ $^

# The receiver (core/geom/receive.h) for systems without POSIX: nothing but standard C may be in it.
SRC_receiver := $(patsubst %,core/%.c,base/arena base/crc32c base/error geom/binding geom/cloud_read geom/delta \
	geom/delta_checksum geom/delta_glb_read geom/delta_read geom/delta_reader geom/draco_extra geom/draco_read geom/glb \
	geom/glb_container geom/guides geom/json geom/json_number geom/lines geom/nodes_read geom/numbers geom/quantise geom/rans \
	geom/receive geom/receive_delta geom/symbols_read geom/topology sim/evaluate) clients/framering.c clients/web/receiver.c
# Motion files and built-in clips, for the viewer.
SRC_motion := core/base/error.c core/base/trig.c $(filter-out clients/motion/load.c,$(wildcard clients/motion/*.c)) clients/web/motion.c
CFLAGS_web := -std=c17 -O2 -ffp-contract=off -fno-tree-slp-vectorize -fno-math-errno $(WARN) -Wmissing-prototypes $(INC_clients)
EXPORTS := -sSTANDALONE_WASM --no-entry -sALLOW_MEMORY_GROWTH -sEXPORTED_FUNCTIONS=_malloc$(,)_free
MINGW_CC ?= x86_64-w64-mingw32-gcc
EMCC ?= emcc
$(B)/receiver.dll: $(SRC_receiver) $(HEADERS)
	@echo "  MINGW $@"
	$(Q)$(MINGW_CC) $(CFLAGS_web) -Wno-float-conversion -shared -o $@ $(SRC_receiver)
$(B)/receiver.wasm: $(SRC_receiver) $(HEADERS)
	@echo "  EMCC $@"
	$(Q)$(EMCC) $(CFLAGS_web) $(EXPORTS) -o $@ $(SRC_receiver)
$(B)/motion.wasm: $(SRC_motion) $(HEADERS)
	@echo "  EMCC $@"
	$(Q)$(EMCC) $(CFLAGS_web) $(EXPORTS) -o $@ $(SRC_motion)

# What the gateway and its pages are built of, beside the files of clients/web.
$(B)/messages.mjs: clients/web/make_messages.mjs proto/messages.def proto/errors.def
	@mkdir -p $(@D)
	@echo "  NODE $@"
	$(Q)node $< proto > $@
web: $(B)/messages.mjs $(B)/receiver.wasm $(B)/motion.wasm

# The client library without its socket, its poll and its random numbers: likewise.
SRC_portable := $(filter core/%,$(SRC_receiver)) $(wildcard proto/*.c) $(patsubst %,clients/%.c,awtclock awtframes awtlead awtpace awtspace \
	awtwrite codec framemix framering openrequests outqueue)
EXPORTS_portable := $(EXPORTS),_awtcodec_init,_awtcodec_next,_awtframes_create,_awtframes_take,_awtframes_show,_awtwrite_points
$(B)/client.dll: $(SRC_portable) $(HEADERS)
	@echo "  MINGW $@"
	$(Q)$(MINGW_CC) $(CFLAGS_web) -D__USE_MINGW_ANSI_STDIO=1 -Wno-float-conversion -shared -o $@ $(SRC_portable)
$(B)/client.wasm: $(SRC_portable) $(HEADERS)
	@echo "  EMCC $@"
	$(Q)$(EMCC) $(CFLAGS_web) $(EXPORTS_portable) -o $@ $(SRC_portable)

# A reader of frames that shares no code with us: tinygltf with Draco, as Debian does not build it (tests/node/check_others.mjs).
$(B)/read_tinygltf: tests/node/read_tinygltf.cc
	@mkdir -p $(@D)
	@echo "  CXX  $@"
	$(Q)$(CXX) -std=c++17 -O1 $(WARN) -o $@ $< -ldraco

room = $(firstword $(subst /, ,$(1)))
$(B)/obj/%.c.o: %.c $(B)/flags
	@mkdir -p $(@D)
	@echo "  CC   $<"
	$(Q)$(CC) $(CFLAGS_ALL) $(INC_$(call room,$<)) -MMD -MP -c -o $@ $<
$(B)/obj/%.cc.o: %.cc $(B)/flags
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	$(Q)$(CXX) $(CXXFLAGS_ALL) $(INC_$(call room,$<)) -MMD -MP -c -o $@ $<

# Another compiler or other flags: everything is built anew.
.PHONY: FORCE
$(B)/flags: FORCE
	@mkdir -p $(@D)
	@echo '$(CC) $(CXX) $(CFLAGS_ALL) $(CXXFLAGS_ALL)' | cmp -s - $@ || echo '$(CC) $(CXX) $(CFLAGS_ALL) $(CXXFLAGS_ALL)' > $@

# The list of tests is what the test files define.
$(B)/test_list.h: $(SRC_unit)
	@mkdir -p $(@D)
	@sed -n 's/^TEST(\([a-z0-9_]*\))$$/TEST_ENTRY(\1)/p' $(filter-out tests/main.c,$(SRC_unit)) > $@
$(B)/obj/tests/main.c.o: $(B)/test_list.h

# The header table, checked on what the compiler really read.
$(B)/rooms.ok: tests/lint/rooms.awk $(call objects,$(SRC_core) $(SRC_proto) $(SRC_server) $(SRC_clients) $(SRC_awtctl) $(SRC_load) $(SRC_loop))
	@awk -f tests/lint/rooms.awk $(patsubst %,$(B)/obj/%.d,$(SRC_core) $(SRC_proto) $(SRC_server) $(SRC_clients) $(SRC_awtctl) $(SRC_load) $(SRC_loop))
	@touch $@

deps:
	@DEPS='$(DEPS)' sh tests/deps.sh run
deps-test:
	@DEPS='$(DEPS)' sh tests/deps.sh test
deps-viewer:
	@DEPS='$(DEPS)' sh tests/deps.sh viewer
deps-soak:
	@DEPS='$(DEPS)' sh tests/deps.sh soak

demo: deps
	@$(MAKE) --no-print-directory programs config=release
	@GROOM='$(GROOM)' MOTION='$(MOTION)' JOINT='$(JOINT)' SCALE='$(SCALE)' UP='$(UP)' HEAD='$(HEAD)' sh clients/demo.sh

viewer: deps-viewer
	@$(MAKE) --no-print-directory programs web config=release
	@sh clients/web/viewer.sh

test: deps-test
	@sh tests/run.sh

soak: deps-soak
	@sh tests/soak.sh

sheets: deps-test
	@$(MAKE) --no-print-directory programs config=release
	@sh tests/render/sheets.sh build/release

pictures: deps-test
	@$(MAKE) --no-print-directory programs web config=release
	@node tests/web/pictures.mjs build/release

bench: programs
	$(B)/awt-bench

bench-service: programs
	@sh tests/bench/service.sh $(B)

format:
	$(Q)clang-format -i $(SRC_ALL) $(HEADERS)
lint: all
	$(Q)clang-format --dry-run --Werror $(SRC_ALL) $(HEADERS)

include clients/install.mk

clean:
	rm -rf build

-include $(patsubst %,$(B)/obj/%.d,$(SRC_ALL))
