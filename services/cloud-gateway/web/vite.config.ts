import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vitest/config';

// TRB_GATEWAY: the gateway that `npm run dev` shows. Its certificate is its own.
const gateway = process.env.TRB_GATEWAY ?? 'https://localhost:8443';
const proxy = { target: gateway, changeOrigin: true, secure: false, headers: { Origin: gateway } };
const proxies = { '/api': { ...proxy, ws: true }, '/metrics': proxy };

export default defineConfig({
  plugins: [svelte()],
  base: '/',
  build: {
    target: 'es2022',
    assetsInlineLimit: 0, // the policy of the gateway allows no data: addresses
    modulePreload: { polyfill: false },
    reportCompressedSize: true,
  },
  server: { proxy: proxies },
  preview: { proxy: proxies },
  test: { include: ['src/**/*.test.ts'] },
});
