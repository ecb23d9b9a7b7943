// files.js: what is dropped on the page: hair, motion or settings, told apart by content and name, as bytes.

const MOST = 256 << 20, SETTINGS_MOST = 1 << 16;

/** 'hair', 'motion' or 'settings'. Throws where it is none. */
function kindOf(name, bytes) {
  const begin = new TextDecoder().decode(bytes.subarray(0, 64));
  if (begin.startsWith('HAIR') || /\.(hair|tfx)$/i.test(name)) {
    return 'hair';
  }
  if (/^\s*HIERARCHY/.test(begin) || /\.(bvh|csv)$/i.test(name)) {
    return 'motion';
  }
  if (/\.json$/i.test(name) && bytes.length <= SETTINGS_MOST) {
    return 'settings';
  }
  throw new Error('it is neither hair (.hair, .tfx) nor motion (.bvh, .csv) nor settings (.json)');
}

/** `uses`: a function of name and bytes for each kind; `failed` is told what is wrong. */
export function acceptFiles(element, picker, uses, failed) {
  const take = async (file) => {
    try {
      if (file.size > MOST) {
        throw new Error('it is longer than 256 MiB');
      }
      const bytes = new Uint8Array(await file.arrayBuffer());
      await uses[kindOf(file.name, bytes)](file.name, bytes);
    } catch (error) {
      failed(`${file.name}: ${error.message}`);
    }
  };
  const over = (event, is) => {
    event.preventDefault();
    element.classList.toggle('dropping', is);
  };
  element.addEventListener('dragover', (event) => over(event, true));
  element.addEventListener('dragleave', (event) => over(event, false));
  element.addEventListener('drop', (event) => {
    over(event, false);
    [...event.dataTransfer.files].forEach(take);
  });
  picker.addEventListener('change', () => {
    [...picker.files].forEach(take);
    picker.value = '';
  });
}

export function saveFile(name, text) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], { type: 'application/json' }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
