import { mount } from 'svelte';
import './app.css';
import App from './App.svelte';
import { speech } from './lib/i18n/i18n.svelte';
import { session } from './lib/session.svelte';
import './lib/theme.svelte';

document.documentElement.lang = speech.language;
void session.find();

const target = document.getElementById('page');
if (target === null) throw new Error('index.html has no #page');
export default mount(App, { target });
