// faces.js: how things stand, for people: a card over the picture for all that is not hair in motion, and passing messages.

const TITLES = { connecting: 'Connecting', empty: 'No hair yet', busy: 'Making hair', lost: 'Connection lost' };
const MESSAGE_MS = 9000;

export class Faces {
  constructor() {
    const find = (id) => document.getElementById(id);
    Object.assign(this, { card: find('face'), title: find('face-title'), text: find('face-text'), bar: find('face-bar'), messages: find('messages') });
  }

  show({ state, reason, share }) {
    document.body.dataset.state = state;
    this.card.hidden = state === 'live';
    this.title.textContent = TITLES[state] ?? '';
    this.text.textContent = { connecting: 'Looking for the daemon …', lost: `${reason}. Trying again …`,
      empty: reason || 'Nobody shows any hair here just now. It will appear as soon as somebody does.' }[state] ?? reason;
    this.bar.hidden = state !== 'busy';
    if (share === null || share === undefined) {
      this.bar.removeAttribute('value');
    } else {
      this.bar.value = share;
    }
  }

  /** A message that goes by itself; `kind`: 'note' or 'error'. */
  say(text, kind = 'note') {
    const message = document.createElement('p');
    message.className = kind;
    message.textContent = text;
    this.messages.append(message);
    setTimeout(() => message.remove(), MESSAGE_MS);
  }
}
