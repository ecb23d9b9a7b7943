# install.mk: what others link, and make install. libawtclient holds the client, the protocol and the reader of frames,
# and needs the C library alone; libawt is core/ with Draco and tinygltf. Only what their headers say can be seen of
# them, in the shared libraries and in the static ones, so that no name of ours meets one of the engine's.
VERSION := $(shell sed -n 's/.*AWTD_VERSION "\(.*\)"/\1/p' core/base/version.h)
SONAME := $(firstword $(subst ., ,$(VERSION)))
SEEN_libawtclient := awtclient_* awthair_* awtsession_* awtlink_* awtframes_* awtclock_* awtlead_* awtpace_* awtspace_* awtwrite_* proto_*
SEEN_libawt := awt_*
NEEDS_libawtclient := -lm
NEEDS_libawt := -ltinygltf -ldraco -lm
SRC_libawtclient := $(patsubst %,clients/%.c,awtclient awthair awtsession awtsession_return awtlink awtlink_receive awtlink_send awtframes awtclock awtlead awtpace awtspace \
	awtwrite backoff codec framemix framering handshake openrequests outqueue sessionbook sessionoptions socket) $(SRC_proto) core/base/options.c $(filter core/%,$(SRC_receiver))
SRC_libawt := $(SRC_core)
HEADERS_libawtclient := $(patsubst %,clients/%.h,awtclient awthair awtsession awtlink awtframes awtclock awtlead awtpace awtspace awtwrite) \
	proto/proto.h proto/messages.def proto/errors.def
HEADERS_libawt := core/awt.h
LIBRARIES := libawt libawtclient

$(B)/pic/%.c.o: %.c $(B)/flags
	@mkdir -p $(@D)
	$(Q)$(CC) $(CFLAGS_ALL) -fPIC $(INC_$(call room,$<)) -MMD -MP -c -o $@ $<
$(B)/pic/%.cc.o: %.cc $(B)/flags
	@mkdir -p $(@D)
	$(Q)$(CXX) $(CXXFLAGS_ALL) -fPIC $(INC_$(call room,$<)) -MMD -MP -c -o $@ $<

define library
$(B)/lib/$(1).map: clients/install.mk
	@mkdir -p $$(@D)
	@echo '$(subst lib,,$(1))_$(SONAME) { global: $(patsubst %,%;,$(SEEN_$(1))) local: *; };' > $$@
$(B)/lib/$(1).so.$(VERSION): $(B)/lib/$(1).map $(patsubst %,$(B)/pic/%.o,$(SRC_$(1)))
	@echo "  SO   $$@"
	$(Q)$(if $(filter %.cc,$(SRC_$(1))),$(CXX),$(CC)) $(FLAGS) $(LDFLAGS) -shared -Wl,-soname,$(1).so.$(SONAME) -Wl,--version-script=$$< \
	-Wl,--no-undefined -o $$@ $$(filter %.o,$$^) $(NEEDS_$(1))
$(B)/lib/$(1).a: $(patsubst %,$(B)/pic/%.o,$(SRC_$(1)))
	@mkdir -p $$(@D)
	@echo "  AR   $$@"
	@rm -f $$@
	$(Q)$(LD) -r -o $(B)/lib/$(1).o $$^
	$(Q)objcopy -w $(patsubst %,--keep-global-symbol='%',$(SEEN_$(1))) $(B)/lib/$(1).o
	$(Q)$(AR) rcs $$@ $(B)/lib/$(1).o
-include $(patsubst %,$(B)/pic/%.d,$(SRC_$(1)))
endef
$(foreach l,$(LIBRARIES),$(eval $(call library,$(l))))

.PHONY: libraries
libraries: $(foreach l,$(LIBRARIES),$(B)/lib/$(l).a $(B)/lib/$(l).so.$(VERSION))

prefix ?= /usr/local
bindir ?= $(prefix)/bin
libdir ?= $(prefix)/lib
includedir ?= $(prefix)/include/awt
mandir ?= $(prefix)/share/man

define install_library
	install -m 644 $(B)/lib/$(1).a $(B)/lib/$(1).so.$(VERSION) $(DESTDIR)$(libdir)
	ln -sf $(1).so.$(VERSION) $(DESTDIR)$(libdir)/$(1).so.$(SONAME)
	ln -sf $(1).so.$(SONAME) $(DESTDIR)$(libdir)/$(1).so
	install -m 644 $(HEADERS_$(1)) $(DESTDIR)$(includedir)
	printf 'prefix=%s\n\nName: %s\nDescription: %s\nVersion: %s\nCflags: -I%s\nLibs: -L%s -l%s\nLibs.private: %s\n' \
	'$(prefix)' '$(1)' 'hair simulation: $(1) of awtd' '$(VERSION)' '$(includedir)' '$(libdir)' '$(subst lib,,$(1))' \
	'$(NEEDS_$(1))$(if $(filter %.cc,$(SRC_$(1))), -lstdc++)' > $(DESTDIR)$(libdir)/pkgconfig/$(subst lib,,$(1)).pc

endef

INSTALLED := $(B)/awtd $(B)/awtctl $(B)/awt-load $(B)/awt-bench
install: programs libraries
	install -d $(DESTDIR)$(bindir) $(DESTDIR)$(libdir)/pkgconfig $(DESTDIR)$(includedir)
	install $(INSTALLED) $(DESTDIR)$(bindir)
	install -d $(DESTDIR)$(mandir)/man1 $(DESTDIR)$(mandir)/man8
	install -m 644 clients/awtctl.1 $(DESTDIR)$(mandir)/man1
	install -m 644 server/awtd.8 $(DESTDIR)$(mandir)/man8
	$(foreach l,$(LIBRARIES),$(call install_library,$(l)))
